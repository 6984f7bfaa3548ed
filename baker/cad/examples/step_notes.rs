//! Prints what is read of STEP files: parts, faces, surfaces by kind, volumes, notes, time.

use rebounce_cad::cast::CastFace;
use rebounce_cad::face::Face;
use rebounce_cad::step;
use rebounce_cad::tessellate;
use std::collections::BTreeMap;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for file in std::env::args().skip(1) {
        let bytes = std::fs::read(&file)?;
        let began = Instant::now();
        let assembly = match step::read(&bytes) {
            Ok(assembly) => assembly,
            Err(error) => {
                println!("{file}: {error}");
                continue;
            }
        };
        let seconds = began.elapsed().as_secs_f64();
        let mut kinds = BTreeMap::<&str, usize>::new();
        let (mut coloured, mut empty) = (0, 0);
        for (face, colour) in assembly.parts.iter().flat_map(|part| &part.faces) {
            *kinds.entry(face.surface.kind()).or_default() += 1;
            coloured += usize::from(colour.is_some());
            empty += usize::from(CastFace::new(face).is_err());
        }
        println!(
            "{file}: {} bytes in {seconds:.3} s; {} parts, {} of them closed, {} occurrences, {} faces, {coloured} of them \
             coloured, {empty} that bound nothing",
            bytes.len(),
            assembly.parts.len(),
            assembly.parts.iter().filter(|part| part.is_closed).count(),
            assembly.instances.len(),
            kinds.values().sum::<usize>(),
        );
        let kinds: Vec<String> = kinds.iter().map(|(kind, count)| format!("{count} {kind}")).collect();
        println!("  {}", kinds.join(", "));
        for part in assembly.parts.iter().filter(|part| part.is_closed) {
            let volume: Option<f64> = part.faces.iter().map(|(face, _)| volume(face)).sum();
            match volume {
                Some(volume) => println!("  {:?}: {:.3} cm³", part.name, 1e6 * volume),
                None => println!("  {:?}: a face has no triangles", part.name),
            }
        }
        for note in &assembly.notes {
            println!("  {note}");
        }
    }
    Ok(())
}

/// What a face adds to the volume of its solid, by the divergence theorem over triangles within 10 µm; `None` without triangles.
fn volume(face: &Face) -> Option<f64> {
    let mesh = tessellate::trimmed(face, 1e-5).ok()?;
    let of = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
        a.dot(b.cross(c)) / 6.0
    };
    let volume: f64 = mesh.triangles.iter().map(of).sum();
    Some(if face.is_reversed { -volume } else { volume })
}
