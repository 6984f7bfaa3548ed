//! Products and their assembly.

use super::file::{File, spoken};
use super::style::Styles;
use super::topology::{BODIES, Bodies};
use super::units::Units;
use super::{Notes, StepError, curves::Geometry};
use crate::model::{Assembly, FaceColour, PartInstance};
use glam::{DAffine3, DMat3, DVec3};
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

/// Nesting of assemblies and of mapped items.
const DEEPEST: usize = 128;

/// Work of one occurrence, in units of the budget.
const VISIT: usize = 4;

/// An occurrence of a product in another.
struct Occurrence {
    id: u64,
    child: u64,
    name: String,
}

/// What is found along a file's assembly.
struct Walk<'a> {
    file: &'a File,
    bodies: Bodies<'a>,
    /// Representations of each product definition.
    shapes: BTreeMap<u64, Vec<u64>>,
    /// The definition that each representation is the shape of.
    owners: HashMap<u64, u64>,
    /// Representations that are the same shape.
    related: HashMap<u64, Vec<u64>>,
    /// Occurrences in each product definition.
    children: BTreeMap<u64, Vec<Occurrence>>,
    /// The relationship that places an occurrence.
    placements: HashMap<u64, u64>,
    units: HashMap<u64, Units>,
    /// Bodies read: the part, if any.
    parts: HashMap<u64, Option<usize>>,
    assembly: Assembly,
}

/// A part of the assembly on the way to its bodies.
struct Context<'a> {
    to_root: DAffine3,
    path: &'a [String],
    colour: FaceColour,
    depth: usize,
}

impl Context<'_> {
    /// What a copy costs.
    fn work(&self) -> usize {
        VISIT + self.path.iter().map(|name| VISIT + name.len()).sum::<usize>()
    }
}

/// From z up to y up.
fn upright() -> DAffine3 {
    DAffine3::from_mat3(DMat3::from_cols(DVec3::X, -DVec3::Z, DVec3::Y))
}

/// Reads all of a file.
pub(super) fn read(file: &File) -> Result<Assembly, StepError> {
    let styles = Styles::new(file);
    let bodies = Bodies { file, styles: &styles, edges: HashMap::new(), notes: Notes::default() };
    let mut walk = Walk::new(file, bodies);
    let definitions: BTreeSet<u64> = walk.shapes.keys().chain(walk.children.keys()).copied().collect();
    let used: HashSet<u64> = walk.children.values().flatten().map(|child| child.child).collect();
    walk.refuse_cycles(&definitions)?;
    for &root in definitions.iter().filter(|id| !used.contains(id)) {
        let path = [walk.name(root)];
        let place = Context { to_root: upright(), path: &path, colour: None, depth: 0 };
        walk.definition(root, &place)?;
    }
    walk.rest()?;
    for _ in file.of_kind("CONTEXT_DEPENDENT_OVER_RIDING_STYLED_ITEM") {
        walk.bodies.notes.add("style", "", "colours of single occurrences are not read");
    }
    let has_bodies = !walk.parts.is_empty();
    let mut assembly = walk.assembly;
    assembly.notes = walk.bodies.notes.sentences();
    if has_bodies || !assembly.notes.is_empty() { Ok(assembly) } else { Err(StepError::Empty) }
}

impl<'a> Walk<'a> {
    fn new(file: &'a File, bodies: Bodies<'a>) -> Self {
        let mut walk = Self {
            file,
            bodies,
            shapes: BTreeMap::new(),
            owners: HashMap::new(),
            related: HashMap::new(),
            children: BTreeMap::new(),
            placements: HashMap::new(),
            units: HashMap::new(),
            parts: HashMap::new(),
            assembly: Assembly::default(),
        };
        walk.link();
        walk
    }

    /// Follows references against their direction, once.
    fn link(&mut self) -> Option<()> {
        let file = self.file;
        let defined = |shape: u64| file.fields(shape, "PRODUCT_DEFINITION_SHAPE")?.optional_reference(2);
        for &id in file.of_kind("SHAPE_DEFINITION_REPRESENTATION") {
            let Some(fields) = file.fields(id, "SHAPE_DEFINITION_REPRESENTATION") else { continue };
            let (Some(shape), Some(representation)) =
                (fields.optional_reference(0), fields.optional_reference(1))
            else {
                continue;
            };
            if let Some(definition) = defined(shape).filter(|id| self.is_definition(*id)) {
                let shapes = self.shapes.entry(definition).or_default();
                if !shapes.contains(&representation) {
                    shapes.push(representation);
                }
                self.owners.entry(representation).or_insert(definition);
            }
        }
        for &id in file.of_kind("NEXT_ASSEMBLY_USAGE_OCCURRENCE") {
            let Some(fields) = file.any_fields(id) else { continue };
            let (Some(parent), Some(child)) = (fields.optional_reference(3), fields.optional_reference(4))
            else {
                continue;
            };
            let name = [fields.text(1), fields.text(5)].into_iter().find(|name| !name.is_empty());
            let name = name.map_or_else(|| self.name(child), str::to_owned);
            self.children.entry(parent).or_default().push(Occurrence { id, child, name });
        }
        for &id in file.of_kind("CONTEXT_DEPENDENT_SHAPE_REPRESENTATION") {
            let Some(fields) = file.any_fields(id) else { continue };
            if let (Some(relation), Some(shape)) =
                (fields.optional_reference(0), fields.optional_reference(1))
                && let Some(occurrence) = defined(shape)
            {
                self.placements.entry(occurrence).or_insert(relation);
            }
        }
        let relations = ["SHAPE_REPRESENTATION_RELATIONSHIP", "REPRESENTATION_RELATIONSHIP"];
        let ids: BTreeSet<u64> = relations.iter().flat_map(|kind| file.of_kind(kind)).copied().collect();
        for id in ids {
            if file.is(id, "REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION") {
                continue;
            }
            if let Some([a, b]) = self.ends(id) {
                self.related.entry(a).or_default().push(b);
                self.related.entry(b).or_default().push(a);
            }
        }
        None
    }

    fn is_definition(&self, id: u64) -> bool {
        ["PRODUCT_DEFINITION", "PRODUCT_DEFINITION_WITH_ASSOCIATED_DOCUMENTS"]
            .iter()
            .any(|kind| self.file.is(id, kind))
    }

    /// The two representations of a relationship.
    fn ends(&self, relation: u64) -> Option<[u64; 2]> {
        let own = self.file.own_fields(relation, "REPRESENTATION_RELATIONSHIP");
        let fields = own.or_else(|| self.file.any_fields(relation))?;
        Some([fields.optional_reference(2)?, fields.optional_reference(3)?])
    }

    /// Name of the product of a definition.
    fn name(&self, definition: u64) -> String {
        let product = || {
            let formation = self.file.any_fields(definition)?.optional_reference(2)?;
            let product = self.file.any_fields(formation)?.optional_reference(2)?;
            let fields = self.file.fields(product, "PRODUCT")?;
            let names = [fields.text(1), fields.text(0)];
            names.into_iter().find(|name| !name.is_empty())
        };
        product().unwrap_or_default().to_owned()
    }

    /// Depth-first search for an assembly within itself.
    fn refuse_cycles(&self, definitions: &BTreeSet<u64>) -> Result<(), StepError> {
        let mut done = HashSet::new();
        let mut open = HashSet::new();
        for &root in definitions {
            let mut stack = vec![(root, 0)];
            while let Some((id, at)) = stack.pop() {
                if at == 0 {
                    if done.contains(&id) {
                        continue;
                    }
                    open.insert(id);
                }
                match self.children.get(&id).and_then(|children| children.get(at)) {
                    Some(child) if open.contains(&child.child) => {
                        return Err(StepError::Cycle(self.name(child.child)));
                    }
                    Some(child) => stack.extend([(id, at + 1), (child.child, 0)]),
                    None => {
                        open.remove(&id);
                        done.insert(id);
                    }
                }
            }
        }
        Ok(())
    }

    fn definition(&mut self, id: u64, place: &Context<'_>) -> Result<(), StepError> {
        if place.depth > DEEPEST {
            return Err(StepError::TooDeep(DEEPEST));
        }
        let shapes = self.same_shapes(id)?;
        let name = self.name(id);
        for shape in shapes {
            self.representation(shape, id, &name, place)?;
        }
        let children = self.children.remove(&id).unwrap_or_default();
        for child in &children {
            self.file.spend(place.work())?;
            let placed = self.placements.get(&child.id).copied();
            let to_parent = match placed.and_then(|relation| self.between(relation, child.child)) {
                Some(to_parent) => to_parent,
                // Then a mapped item of the assembly places it.
                None if placed.is_none() && self.is_mapped(id, child.child)? => continue,
                None => {
                    let why = "occurrences without a placement that can be read stand at the origin";
                    self.bodies.notes.add("occurrence", &name, why);
                    DAffine3::IDENTITY
                }
            };
            let path = [place.path, std::slice::from_ref(&child.name)].concat();
            let to_root = place.to_root * to_parent;
            let place = Context { to_root, path: &path, colour: place.colour, depth: place.depth + 1 };
            self.definition(child.child, &place)?;
        }
        if !children.is_empty() {
            self.children.insert(id, children);
        }
        Ok(())
    }

    /// Representations of a definition and those related to them as the same shape.
    fn same_shapes(&self, definition: u64) -> Result<Vec<u64>, StepError> {
        let mut shapes = self.shapes.get(&definition).cloned().unwrap_or_default();
        let mut seen: HashSet<u64> = shapes.iter().copied().collect();
        let mut at = 0;
        while let Some(shape) = shapes.get(at).copied() {
            let related = self.related.get(&shape).map_or(&[][..], Vec::as_slice);
            self.file.spend(VISIT + related.len())?;
            for &other in related {
                let is_own = self.owners.get(&other).is_none_or(|owner| *owner == definition);
                if is_own && seen.insert(other) {
                    shapes.push(other);
                }
            }
            at += 1;
        }
        Ok(shapes)
    }

    /// Whether a mapped item among the shapes of a definition brings a shape of another.
    fn is_mapped(&self, definition: u64, child: u64) -> Result<bool, StepError> {
        for shape in self.same_shapes(definition)? {
            let items = self.items(shape).unwrap_or_default();
            self.file.spend(items.len())?;
            if items.into_iter().any(|item| self.mapped_owner(item) == Some(child)) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn mapped(&self, item: u64) -> Option<(u64, u64, u64)> {
        let fields = self.file.fields(item, "MAPPED_ITEM")?;
        let map = self.file.fields(fields.optional_reference(1)?, "REPRESENTATION_MAP")?;
        Some((map.optional_reference(0)?, map.optional_reference(1)?, fields.optional_reference(2)?))
    }

    fn mapped_owner(&self, item: u64) -> Option<u64> {
        let (_, representation, _) = self.mapped(item)?;
        self.owners.get(&representation).copied()
    }

    /// Attributes of a representation: name, items, context.
    fn items(&self, representation: u64) -> Option<Vec<u64>> {
        let own = self.file.own_fields(representation, "REPRESENTATION");
        own.or_else(|| self.file.any_fields(representation))?.references(1).ok()
    }

    fn units_of(&mut self, representation: u64) -> Units {
        if let Some(units) = self.units.get(&representation) {
            return *units;
        }
        let own = self.file.own_fields(representation, "REPRESENTATION");
        let fields = own.or_else(|| self.file.any_fields(representation));
        let context = fields.and_then(|fields| fields.optional_reference(2)).unwrap_or_default();
        let (units, is_given) = Units::of_context(self.file, context);
        if !is_given {
            self.bodies.notes.add(
                "representation",
                "",
                "no unit of length is given: millimetres are assumed",
            );
        }
        self.units.insert(representation, units);
        units
    }

    fn representation(
        &mut self,
        id: u64,
        owner: u64,
        name: &str,
        place: &Context<'_>,
    ) -> Result<(), StepError> {
        if place.depth > DEEPEST {
            return Err(StepError::TooDeep(DEEPEST));
        }
        let Some(items) = self.items(id) else {
            self.bodies.notes.add("representation", name, "its items cannot be read");
            return Ok(());
        };
        self.file.spend(VISIT + items.len())?;
        let colour = self.bodies.styles.of(id).or(place.colour);
        for item in items {
            let kind = self.file.kind(item, &BODIES).unwrap_or_default();
            if BODIES.contains(&kind) {
                let units = self.units_of(id);
                self.add_solid(item, units, name, &Context { colour, ..*place })?;
            } else if kind == "MAPPED_ITEM" {
                self.mapped_item(item, id, owner, name, &Context { colour, ..*place })?;
            } else if !is_no_body(kind) {
                let why = format!("{}s are not read", spoken(kind));
                self.bodies.notes.add("item", name, &why);
            }
        }
        Ok(())
    }

    fn mapped_item(
        &mut self,
        item: u64,
        within: u64,
        owner: u64,
        name: &str,
        place: &Context<'_>,
    ) -> Result<(), StepError> {
        let Some((origin, representation, target)) = self.mapped(item) else {
            self.bodies.notes.add("mapped item", name, "its source or target cannot be read");
            return Ok(());
        };
        let product = self.owners.get(&representation).copied();
        // An occurrence that places the same product has it already.
        let is_placed =
            |child: &Occurrence| Some(child.child) == product && self.placements.contains_key(&child.id);
        if self.children.get(&owner).is_some_and(|children| children.iter().any(is_placed)) {
            return Ok(());
        }
        let (from, to) = (self.units_of(representation), self.units_of(within));
        let to_parent = self.frame(origin, from).zip(self.operator(target, to));
        let Some((origin, target)) = to_parent else {
            self.bodies.notes.add("mapped item", name, "its source or target cannot be read");
            return Ok(());
        };
        let product_name = product.map(|product| self.name(product)).filter(|name| !name.is_empty());
        let label = self.file.fields(item, "MAPPED_ITEM").map_or("", |fields| fields.text(0)).to_owned();
        let step = if label.is_empty() { product_name.clone().unwrap_or_default() } else { label };
        let step = (!step.is_empty()).then_some(step);
        let path = [place.path, step.as_slice()].concat();
        let place = Context {
            to_root: place.to_root * target * origin.inverse(),
            path: &path,
            colour: self.bodies.styles.of(item).or(place.colour),
            depth: place.depth + 1,
        };
        match product {
            // With all that it is made of; a representation that brings its own product does not end.
            Some(product) if product != owner => self.definition(product, &place),
            _ => self.representation(representation, owner, product_name.as_deref().unwrap_or(name), &place),
        }
    }

    fn add_solid(
        &mut self,
        item: u64,
        units: Units,
        name: &str,
        place: &Context<'_>,
    ) -> Result<(), StepError> {
        let part = match self.parts.get(&item) {
            Some(part) => *part,
            None => {
                let own = self.file.any_fields(item).map_or("", |fields| fields.text(0));
                let name = if name.is_empty() { own } else { name };
                let part = self.bodies.part(units, item, name, place.colour)?;
                let part = part.map(|part| {
                    self.assembly.parts.push(part);
                    self.assembly.parts.len() - 1
                });
                self.parts.insert(item, part);
                part
            }
        };
        if let Some(part) = part {
            self.file.spend(place.work())?;
            let path = place.path.to_vec();
            self.assembly.instances.push(PartInstance { part, path, world_from_part: place.to_root });
        }
        Ok(())
    }

    /// Bodies that no product has: all that there are if the file has no products with a shape, else named.
    fn rest(&mut self) -> Result<(), StepError> {
        let is_bare = self.parts.is_empty();
        let solids = BODIES.iter().take(5).flat_map(|kind| self.file.of_kind(kind)).copied();
        let solids: BTreeSet<u64> = solids.filter(|id| !self.parts.contains_key(id)).collect();
        if solids.is_empty() {
            return Ok(());
        }
        let mut within = HashMap::new();
        for kind in self.file.kinds(|kind| kind.ends_with("REPRESENTATION")) {
            for &id in self.file.of_kind(kind) {
                for item in self.items(id).unwrap_or_default() {
                    within.entry(item).or_insert(id);
                }
            }
        }
        for item in solids {
            if !is_bare {
                self.bodies.notes.add("body", "", "it belongs to no product's shape and is left out");
                continue;
            }
            let units = match within.get(&item) {
                Some(representation) => self.units_of(*representation),
                None => self.units_of(0),
            };
            let name = self.file.any_fields(item).map_or("", |fields| fields.text(0)).to_owned();
            let path = [name.clone()];
            self.add_solid(
                item,
                units,
                &name,
                &Context { to_root: upright(), path: &path, colour: None, depth: 0 },
            )?;
        }
        Ok(())
    }

    /// The placement of a child's shape in its parent's by a relationship with a transformation.
    fn between(&mut self, relation: u64, child: u64) -> Option<DAffine3> {
        let [first, second] = self.ends(relation)?;
        let own = self.file.own_fields(relation, "REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION");
        let transformation = match own {
            Some(fields) => fields.optional_reference(0)?,
            None => self.file.any_fields(relation)?.optional_reference(4)?,
        };
        let (first_units, second_units) = (self.units_of(first), self.units_of(second));
        // From the first representation to the second.
        let to_second = match self.file.fields(transformation, "ITEM_DEFINED_TRANSFORMATION") {
            Some(fields) => {
                let from = self.frame(fields.optional_reference(2)?, first_units)?;
                self.operator(fields.optional_reference(3)?, second_units)? * from.inverse()
            }
            None => self.operator(transformation, second_units)?,
        };
        // The first is the child's, as it should be, unless the second clearly is.
        let owns = |shape: u64| self.owners.get(&shape) == Some(&child);
        let is_turned = owns(second) && !owns(first);
        Some(if is_turned { to_second.inverse() } else { to_second })
    }

    fn frame(&self, id: u64, units: Units) -> Option<DAffine3> {
        let frame = Geometry { file: self.file, units }.frame(id).ok()?;
        let matrix = DMat3::from_cols(frame.x, frame.y, frame.z);
        Some(DAffine3::from_mat3_translation(matrix, frame.origin))
    }

    /// A placement, or a `cartesian_transformation_operator_3d`.
    fn operator(&self, id: u64, units: Units) -> Option<DAffine3> {
        let Some(fields) = self.file.fields(id, "CARTESIAN_TRANSFORMATION_OPERATOR_3D") else {
            return self.frame(id, units);
        };
        let geometry = Geometry { file: self.file, units };
        let direction = |at: usize| geometry.direction(fields.optional_reference(at)?).ok()?.try_normalize();
        // Axes 1 and 2, origin, scale and axis 3 come last, after names.
        let last = fields.len().checked_sub(1)?;
        let base = last.checked_sub(4)?;
        let z = direction(last).unwrap_or(DVec3::Z);
        let reference = direction(base).unwrap_or(if z.x.abs() > 0.99 { DVec3::Y } else { DVec3::X });
        let x = (reference - reference.dot(z) * z).try_normalize()?;
        let y = z.cross(x);
        let y = if direction(base + 1).is_some_and(|axis| axis.dot(y) < 0.0) { -y } else { y };
        let origin = geometry.point(fields.optional_reference(base + 2)?).ok()?;
        let scale = fields.real(base + 3).unwrap_or(1.0);
        (scale > 0.0).then(|| DAffine3::from_mat3_translation(scale * DMat3::from_cols(x, y, z), origin))
    }
}

/// Items of representations that have no surfaces to show.
fn is_no_body(kind: &str) -> bool {
    kind.contains("PLACEMENT") || kind.ends_with("POINT") || kind.ends_with("DIRECTION") || kind.is_empty()
}
