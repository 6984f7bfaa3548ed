//! Laws of the reader: areas, volumes, closed shells, placements; on texts written here, and on a file if it is there.

mod assembly;
mod bench;
mod hostile;
mod integrate;
mod periods;
mod shapes;
mod splines;
mod text;

use super::Notes;
use super::file::File;
use super::style::Styles;
use super::topology::Bodies;
use super::units::Units;
use crate::model::Assembly;
use std::collections::{BTreeMap, HashMap};

/// Reads a text that must be readable.
fn read(text: &str) -> Assembly {
    super::read(text.as_bytes()).unwrap()
}

/// The law of closed shells: in each solid every edge is run once each way.
fn assert_closed(bytes: &[u8]) {
    let file = File::parse(bytes).unwrap();
    let styles = Styles::new(&file);
    let mut bodies = Bodies { file: &file, styles: &styles, edges: HashMap::new(), notes: Notes::default() };
    let solids = ["MANIFOLD_SOLID_BREP", "BREP_WITH_VOIDS"].into_iter().flat_map(|kind| file.of_kind(kind));
    let mut count = 0;
    for &solid in solids {
        let mut runs = BTreeMap::<u64, [usize; 2]>::new();
        let uses = bodies.uses(solid, None).unwrap_or_else(|_| panic!("#{solid}")).0;
        for each in uses {
            let bounded = bodies.bounded(Units::NONE, each.face).unwrap_or_else(|_| panic!("#{}", each.face));
            for (edge, forward) in bounded.runs {
                runs.entry(edge).or_default()[usize::from(forward != each.is_flipped)] += 1;
            }
        }
        assert!(runs.values().all(|ways| *ways == [1, 1]), "#{solid}: {runs:?}");
        count += 1;
    }
    assert!(count > 0);
}
