//! Writer of small STEP files.

use glam::{DQuat, DVec3};
use std::fmt::Write;
use std::hash::{Hash, Hasher};

/// A STEP file under way.
pub struct Text {
    body: String,
    last: u64,
}

/// A list of references.
pub fn list(ids: &[u64]) -> String {
    let ids: Vec<String> = ids.iter().map(|id| format!("#{id}")).collect();
    format!("({})", ids.join(","))
}

impl Text {
    pub fn new() -> Self {
        Self { body: String::new(), last: 0 }
    }

    /// One more record; its number.
    pub fn add(&mut self, record: impl AsRef<str>) -> u64 {
        self.last += 1;
        writeln!(self.body, "#{} = {};", self.last, record.as_ref()).unwrap();
        self.last
    }

    /// The file; it is kept in the folder that REBOUNCE_STEP_TEXTS names, if it names one.
    pub fn finish(&self) -> String {
        let text = self.text();
        if let Some(folder) = std::env::var_os("REBOUNCE_STEP_TEXTS") {
            let mut hash = std::hash::DefaultHasher::new();
            text.hash(&mut hash);
            let file = format!("{:016x}.step", hash.finish());
            std::fs::write(std::path::Path::new(&folder).join(file), &text).unwrap();
        }
        text
    }

    fn text(&self) -> String {
        format!(
            "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n\
             FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\n{}ENDSEC;\nEND-ISO-10303-21;\n",
            self.body
        )
    }

    pub fn point(&mut self, at: DVec3) -> u64 {
        self.add(format!("CARTESIAN_POINT('',({:?},{:?},{:?}))", at.x, at.y, at.z))
    }

    pub fn direction(&mut self, at: DVec3) -> u64 {
        self.add(format!("DIRECTION('',({:?},{:?},{:?}))", at.x, at.y, at.z))
    }

    pub fn frame(&mut self, origin: DVec3, axis: DVec3, reference: DVec3) -> u64 {
        let (origin, axis) = (self.point(origin), self.direction(axis));
        let reference = self.direction(reference);
        self.add(format!("AXIS2_PLACEMENT_3D('',#{origin},#{axis},#{reference})"))
    }

    pub fn vertex(&mut self, at: DVec3) -> u64 {
        let at = self.point(at);
        self.add(format!("VERTEX_POINT('',#{at})"))
    }

    /// A straight edge between vertices at these places.
    pub fn straight(&mut self, ends: [u64; 2], from: DVec3, to: DVec3) -> u64 {
        let (origin, direction) = (self.point(from), self.direction(to - from));
        let vector = self.add(format!("VECTOR('',#{direction},1.)"));
        let line = self.add(format!("LINE('',#{origin},#{vector})"));
        self.edge(ends, line, true)
    }

    pub fn edge(&mut self, [from, to]: [u64; 2], curve: u64, same_sense: bool) -> u64 {
        self.add(format!("EDGE_CURVE('',#{from},#{to},#{curve},{})", flag(same_sense)))
    }

    /// A whole circle from a vertex on its reference direction.
    pub fn circle(&mut self, centre: DVec3, axis: DVec3, reference: DVec3, radius: f64) -> u64 {
        let frame = self.frame(centre, axis, reference);
        let circle = self.add(format!("CIRCLE('',#{frame},{radius:?})"));
        let vertex = self.vertex(centre + radius * reference);
        self.edge([vertex; 2], circle, true)
    }

    pub fn bound(&mut self, edges: &[(u64, bool)]) -> u64 {
        let edges: Vec<u64> = edges
            .iter()
            .map(|(edge, forward)| self.add(format!("ORIENTED_EDGE('',*,*,#{edge},{})", flag(*forward))))
            .collect();
        let edges = self.add(format!("EDGE_LOOP('',{})", list(&edges)));
        self.add(format!("FACE_BOUND('',#{edges},.T.)"))
    }

    pub fn face(&mut self, surface: u64, bounds: &[u64], same_sense: bool) -> u64 {
        self.add(format!("ADVANCED_FACE('',{},#{surface},{})", list(bounds), flag(same_sense)))
    }

    pub fn solid(&mut self, name: &str, faces: &[u64]) -> u64 {
        let shell = self.add(format!("CLOSED_SHELL('',{})", list(faces)));
        self.add(format!("MANIFOLD_SOLID_BREP('{name}',#{shell})"))
    }

    /// A context in millimetres and radians.
    pub fn millimetres(&mut self) -> u64 {
        let length = self.add("( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.) )");
        let angle = self.add("( NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.) )");
        self.context(length, angle)
    }

    /// A context in inches and degrees.
    pub fn inches(&mut self) -> u64 {
        let metre = self.add("( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT($,.METRE.) )");
        let inch = self.add(format!("LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(0.0254),#{metre})"));
        let length =
            self.add(format!("( CONVERSION_BASED_UNIT('INCH',#{inch}) LENGTH_UNIT() NAMED_UNIT(*) )"));
        let radian = self.add("( NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.) )");
        let degree = std::f64::consts::PI / 180.0;
        let degree =
            self.add(format!("PLANE_ANGLE_MEASURE_WITH_UNIT(PLANE_ANGLE_MEASURE({degree:?}),#{radian})"));
        let angle = self
            .add(format!("( CONVERSION_BASED_UNIT('DEGREE',#{degree}) NAMED_UNIT(*) PLANE_ANGLE_UNIT() )"));
        self.context(length, angle)
    }

    fn context(&mut self, length: u64, angle: u64) -> u64 {
        self.add(format!(
            "( GEOMETRIC_REPRESENTATION_CONTEXT(3) GLOBAL_UNIT_ASSIGNED_CONTEXT((#{length},#{angle})) \
             REPRESENTATION_CONTEXT('','') )"
        ))
    }

    /// A product with one representation; numbers of the definition and the representation.
    pub fn product(&mut self, name: &str, items: &[u64], context: u64) -> [u64; 2] {
        let product = self.add(format!("PRODUCT('{name}','{name}','',())"));
        let formation = self.add(format!("PRODUCT_DEFINITION_FORMATION('','',#{product})"));
        let definition = self.add(format!("PRODUCT_DEFINITION('design','',#{formation},$)"));
        let shape = self.add(format!("PRODUCT_DEFINITION_SHAPE('','',#{definition})"));
        let representation =
            self.add(format!("ADVANCED_BREP_SHAPE_REPRESENTATION('',{},#{context})", list(items)));
        self.add(format!("SHAPE_DEFINITION_REPRESENTATION(#{shape},#{representation})"));
        [definition, representation]
    }

    /// An occurrence of a child in a parent, both as `product` gives them, placed from one frame to the other.
    pub fn occurrence(&mut self, name: &str, parent: [u64; 2], child: [u64; 2], from: u64, to: u64) {
        let occurrence = self
            .add(format!("NEXT_ASSEMBLY_USAGE_OCCURRENCE('1','{name}','',#{},#{},$)", parent[0], child[0]));
        let shape = self.add(format!("PRODUCT_DEFINITION_SHAPE('','',#{occurrence})"));
        let transformation = self.add(format!("ITEM_DEFINED_TRANSFORMATION('','',#{from},#{to})"));
        let relation = self.add(format!(
            "( REPRESENTATION_RELATIONSHIP('','',#{},#{}) \
             REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#{transformation}) \
             SHAPE_REPRESENTATION_RELATIONSHIP() )",
            child[1], parent[1]
        ));
        self.add(format!("CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#{relation},#{shape})"));
    }

    /// A box from the origin to `size`, turned and moved; its faces too.
    pub fn cuboid(&mut self, size: DVec3, turn: DQuat, origin: DVec3) -> (u64, Vec<u64>) {
        let place = |at: usize| {
            let bit = |axis: usize| ((at >> axis) & 1) as f64;
            origin + turn * (size * DVec3::new(bit(0), bit(1), bit(2)))
        };
        let vertices: Vec<u64> = (0..8).map(|at| self.vertex(place(at))).collect();
        let mut edges = std::collections::HashMap::new();
        let mut faces = Vec::new();
        for axis in 0..3 {
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            for high in [false, true] {
                // Counter-clockwise about +axis.
                let base = usize::from(high) << axis;
                let corners = [base, base | 1 << next, base | 1 << next | 1 << last, base | 1 << last];
                let mut bound = Vec::new();
                for side in 0..4 {
                    let (a, b) = (corners[side], corners[(side + 1) % 4]);
                    let key = (a.min(b), a.max(b));
                    let edge = *edges.entry(key).or_insert_with(|| {
                        self.straight([vertices[key.0], vertices[key.1]], place(key.0), place(key.1))
                    });
                    bound.push((edge, a < b));
                }
                if !high {
                    bound.reverse();
                    bound.iter_mut().for_each(|(_, forward)| *forward = !*forward);
                }
                let bound = self.bound(&bound);
                let axes = [DVec3::X, DVec3::Y, DVec3::Z];
                let frame = self.frame(place(base), turn * axes[axis], turn * axes[next]);
                let plane = self.add(format!("PLANE('',#{frame})"));
                faces.push(self.face(plane, &[bound], high));
            }
        }
        (self.solid("box", &faces), faces)
    }
}

fn flag(value: bool) -> &'static str {
    if value { ".T." } else { ".F." }
}
