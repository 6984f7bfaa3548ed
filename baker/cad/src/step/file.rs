//! Records of a STEP file: the clear text encoding of ISO 10303-21, with its entities by number and by type.

use super::{Flaw, Read, StepError};
use std::cell::Cell;
use std::collections::{BTreeMap, HashMap};
use step_io::parser::{Attribute, RawEntity};

/// Work that reading a file may cost, of which control points, faces, samples and occurrences take their share: so much and so
/// much more a byte. Honest files stay far below; one that refers to the same large entity again and again does not.
const BUDGET: [u64; 2] = [20_000_000, 200];

/// A file's records.
pub(super) struct File {
    records: BTreeMap<u64, RawEntity>,
    kinds: HashMap<String, Vec<u64>>,
    budget: Cell<u64>,
}

/// Attributes of one record, inherited ones first.
pub(super) struct Fields<'a> {
    /// Number of the record.
    pub id: u64,
    list: Vec<&'a Attribute>,
}

impl File {
    /// Parses the text; numbers beyond double precision are refused. The parser is written not to panic; should it do so all the same, that is caught here and only here
    /// (not under WebAssembly, where a panic ends the program).
    pub fn parse(bytes: &[u8]) -> Result<Self, StepError> {
        let parse = || step_io::parser::parse(bytes).map_err(|error| StepError::Syntax(error.to_string()));
        #[cfg(not(target_family = "wasm"))]
        let graph = std::panic::catch_unwind(parse)
            .unwrap_or_else(|_| Err(StepError::Syntax("the parser failed on it".into())))?;
        #[cfg(target_family = "wasm")]
        let graph = parse()?;
        let budget = BUDGET[0] + BUDGET[1] * bytes.len() as u64;
        let mut kinds = HashMap::<String, Vec<u64>>::new();
        for (&id, record) in &graph.entities {
            let mut name = |name: &String| match kinds.get_mut(name) {
                Some(ids) => ids.push(id),
                None => drop(kinds.insert(name.clone(), vec![id])),
            };
            match record {
                RawEntity::Simple { name: kind, .. } => name(kind),
                RawEntity::Complex { parts, .. } => parts.iter().for_each(|part| name(&part.name)),
            }
        }
        Ok(Self { records: graph.entities, kinds, budget: Cell::new(budget) })
    }

    /// Takes work from the budget.
    pub fn spend(&self, work: usize) -> Result<(), StepError> {
        let left = self.budget.get().checked_sub(work as u64).ok_or(StepError::TooLarge)?;
        self.budget.set(left);
        Ok(())
    }

    /// Numbers of the records of this type, ascending.
    pub fn of_kind(&self, kind: &str) -> &[u64] {
        self.kinds.get(kind).map_or(&[], Vec::as_slice)
    }

    /// Types in the file whose name passes.
    pub fn kinds(&self, passes: impl Fn(&str) -> bool) -> impl Iterator<Item = &str> {
        self.kinds.keys().map(String::as_str).filter(move |kind| passes(kind))
    }

    /// Whether the record is of this type, or has it among its parts.
    pub fn is(&self, id: u64, kind: &str) -> bool {
        match self.records.get(&id) {
            Some(RawEntity::Simple { name, .. }) => name == kind,
            Some(RawEntity::Complex { parts, .. }) => parts.iter().any(|part| part.name == kind),
            None => false,
        }
    }

    /// Its type; of a record of several parts the first that `known` lists, else the longest name.
    pub fn kind(&self, id: u64, known: &[&'static str]) -> Read<&str> {
        match self.records.get(&id) {
            Some(RawEntity::Simple { name, .. }) => Ok(name),
            Some(RawEntity::Complex { parts, .. }) => {
                let name = known.iter().find(|kind| parts.iter().any(|part| part.name == **kind));
                let longest = || parts.iter().map(|part| part.name.as_str()).max_by_key(|name| name.len());
                name.copied().or_else(longest).ok_or_else(|| broken(id))
            }
            None => Err(Flaw::UnreadAt(id, "an entity is missing".into())),
        }
    }

    /// The attributes, if the record is of this type: as written, or gathered from its parts.
    pub fn fields(&self, id: u64, kind: &str) -> Option<Fields<'_>> {
        match self.records.get(&id)? {
            RawEntity::Simple { name, attributes, .. } if name == kind => {
                Some(Fields { id, list: attributes.iter().collect() })
            }
            RawEntity::Complex { parts, .. } if parts.iter().any(|part| part.name == kind) => {
                let inherited = supertypes(kind).iter().copied().chain([kind]);
                let part = |name| parts.iter().find(|part| part.name == name);
                let list = inherited.filter_map(part).flat_map(|part| &part.attributes).collect();
                Some(Fields { id, list })
            }
            _ => None,
        }
    }

    /// Attributes that one part of a record of several parts has by itself.
    pub fn own_fields(&self, id: u64, kind: &str) -> Option<Fields<'_>> {
        let RawEntity::Complex { parts, .. } = self.records.get(&id)? else { return None };
        let part = parts.iter().find(|part| part.name == kind)?;
        Some(Fields { id, list: part.attributes.iter().collect() })
    }

    /// The attributes of a record that should be of this type.
    pub fn expect(&self, id: u64, kind: &str) -> Read<Fields<'_>> {
        self.fields(id, kind)
            .ok_or_else(|| Flaw::UnreadAt(id, format!("an entity is not the {} it should be", spoken(kind))))
    }

    /// The attributes of a record whatever its type; of several parts all in a row.
    pub fn any_fields(&self, id: u64) -> Option<Fields<'_>> {
        let list = match self.records.get(&id)? {
            RawEntity::Simple { attributes, .. } => attributes.iter().collect(),
            RawEntity::Complex { parts, .. } => parts.iter().flat_map(|part| &part.attributes).collect(),
        };
        Some(Fields { id, list })
    }
}

/// Parts whose attributes come before those of a type.
fn supertypes(kind: &str) -> &'static [&'static str] {
    match kind {
        "CIRCLE" | "ELLIPSE" | "HYPERBOLA" | "PARABOLA" => &["REPRESENTATION_ITEM", "CONIC"],
        "PLANE" | "CYLINDRICAL_SURFACE" | "CONICAL_SURFACE" | "SPHERICAL_SURFACE" | "TOROIDAL_SURFACE" => {
            &["REPRESENTATION_ITEM", "ELEMENTARY_SURFACE"]
        }
        "DEGENERATE_TOROIDAL_SURFACE" => &["REPRESENTATION_ITEM", "ELEMENTARY_SURFACE", "TOROIDAL_SURFACE"],
        "SURFACE_OF_REVOLUTION" | "SURFACE_OF_LINEAR_EXTRUSION" => &["REPRESENTATION_ITEM", "SWEPT_SURFACE"],
        "SEAM_CURVE" | "INTERSECTION_CURVE" => &["REPRESENTATION_ITEM", "SURFACE_CURVE"],
        "AXIS1_PLACEMENT" | "AXIS2_PLACEMENT_2D" | "AXIS2_PLACEMENT_3D" => {
            &["REPRESENTATION_ITEM", "PLACEMENT"]
        }
        "EDGE_CURVE" | "ORIENTED_EDGE" => &["REPRESENTATION_ITEM", "EDGE"],
        "EDGE_LOOP" => &["REPRESENTATION_ITEM", "PATH"],
        "FACE_OUTER_BOUND" => &["REPRESENTATION_ITEM", "FACE_BOUND"],
        "FACE_SURFACE" => &["REPRESENTATION_ITEM", "FACE"],
        "ADVANCED_FACE" => &["REPRESENTATION_ITEM", "FACE", "FACE_SURFACE"],
        "CLOSED_SHELL" | "OPEN_SHELL" => &["REPRESENTATION_ITEM", "CONNECTED_FACE_SET"],
        "BREP_WITH_VOIDS" | "FACETED_BREP" => &["REPRESENTATION_ITEM", "MANIFOLD_SOLID_BREP"],
        "OVER_RIDING_STYLED_ITEM" => &["REPRESENTATION_ITEM", "STYLED_ITEM"],
        "LENGTH_MEASURE_WITH_UNIT" | "PLANE_ANGLE_MEASURE_WITH_UNIT" => &["MEASURE_WITH_UNIT"],
        _ => &["REPRESENTATION_ITEM"],
    }
}

/// `OFFSET_SURFACE` as "offset surface".
pub(super) fn spoken(kind: &str) -> String {
    kind.to_lowercase().replace('_', " ")
}

/// What a record says cannot be.
pub(super) fn broken(id: u64) -> Flaw {
    Flaw::UnreadAt(id, "attributes are missing or of the wrong kind".into())
}

/// What a typed value holds.
fn bare(mut attribute: &Attribute) -> &Attribute {
    while let Attribute::Typed { value, .. } = attribute {
        attribute = value;
    }
    attribute
}

fn as_count(it: &Attribute) -> Option<usize> {
    match bare(it) {
        Attribute::Integer(value) => usize::try_from(*value).ok(),
        _ => None,
    }
}

fn as_row<T>(row: &Attribute, get: impl Fn(&Attribute) -> Option<T>) -> Option<Vec<T>> {
    match row {
        Attribute::List(row) => row.iter().map(get).collect(),
        _ => None,
    }
}

fn as_real(attribute: &Attribute) -> Option<f64> {
    match bare(attribute) {
        Attribute::Real(value) => Some(*value),
        Attribute::Integer(value) => Some(*value as f64),
        _ => None,
    }
}

fn as_reference(attribute: &Attribute) -> Option<u64> {
    match bare(attribute) {
        Attribute::EntityRef(id) => Some(*id),
        _ => None,
    }
}

impl<'a> Fields<'a> {
    /// How many.
    pub fn len(&self) -> usize {
        self.list.len()
    }

    fn list(&self, at: usize) -> Option<&'a [Attribute]> {
        match bare(self.list.get(at)?) {
            Attribute::List(list) => Some(list),
            _ => None,
        }
    }

    fn each<T>(
        &self,
        list: Option<&'a [Attribute]>,
        get: impl Fn(&'a Attribute) -> Option<T>,
    ) -> Read<Vec<T>> {
        list.and_then(|list| list.iter().map(get).collect()).ok_or_else(|| broken(self.id))
    }

    /// A real number.
    pub fn real(&self, at: usize) -> Read<f64> {
        self.list.get(at).and_then(|it| as_real(it)).ok_or_else(|| broken(self.id))
    }

    /// A list of them.
    pub fn reals(&self, at: usize) -> Read<Vec<f64>> {
        self.each(self.list(at), as_real)
    }

    /// A list of lists of them.
    pub fn real_rows(&self, at: usize) -> Read<Vec<Vec<f64>>> {
        self.each(self.list(at), |row| as_row(row, as_real))
    }

    /// A count.
    pub fn count(&self, at: usize) -> Read<usize> {
        self.list.get(at).and_then(|it| as_count(it)).ok_or_else(|| broken(self.id))
    }

    /// A list of them.
    pub fn counts(&self, at: usize) -> Read<Vec<usize>> {
        self.each(self.list(at), as_count)
    }

    /// The number of another record.
    pub fn reference(&self, at: usize) -> Read<u64> {
        self.optional_reference(at).ok_or_else(|| broken(self.id))
    }

    /// The number of another record, if there is one.
    pub fn optional_reference(&self, at: usize) -> Option<u64> {
        self.list.get(at).and_then(|it| as_reference(it))
    }

    /// A list of them.
    pub fn references(&self, at: usize) -> Read<Vec<u64>> {
        self.each(self.list(at), as_reference)
    }

    /// A list of lists of them.
    pub fn reference_rows(&self, at: usize) -> Read<Vec<Vec<u64>>> {
        self.each(self.list(at), |row| as_row(row, as_reference))
    }

    /// Those references in a list that there are, and the values that are none.
    pub fn mixed(&self, at: usize) -> (Vec<u64>, Vec<f64>) {
        let list = self.list(at).unwrap_or_default();
        (list.iter().filter_map(as_reference).collect(), list.iter().filter_map(as_real).collect())
    }

    /// All references among the attributes, lists opened once.
    pub fn all_references(&self) -> Vec<u64> {
        let open = |it: &&'a Attribute| match bare(it) {
            Attribute::List(list) => list.iter().filter_map(as_reference).collect(),
            it => as_reference(it).into_iter().collect::<Vec<_>>(),
        };
        self.list.iter().flat_map(open).collect()
    }

    /// A string, or empty.
    pub fn text(&self, at: usize) -> &'a str {
        match self.list.get(at).map(|it| bare(it)) {
            Some(Attribute::String(text)) => text.trim(),
            _ => "",
        }
    }

    /// An enumeration value, or empty.
    pub fn word(&self, at: usize) -> &'a str {
        match self.list.get(at).map(|it| bare(it)) {
            Some(Attribute::Enum(word)) => word,
            _ => "",
        }
    }

    /// A boolean; what is neither true nor false counts as true.
    pub fn flag(&self, at: usize) -> bool {
        !matches!(self.word(at), "F" | "FALSE" | "f")
    }
}
