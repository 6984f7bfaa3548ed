//! Units of a representation's context.

use super::file::File;

/// Factors to metres and radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Units {
    /// Metres a unit of length.
    pub length: f64,
    /// Radians a unit of plane angle.
    pub angle: f64,
}

impl Units {
    /// Numbers as they are: parameter planes.
    pub const NONE: Self = Self { length: 1.0, angle: 1.0 };

    /// Those of a context. Where it names none: millimetres and radians, and `false`.
    pub fn of_context(file: &File, context: u64) -> (Self, bool) {
        let mut units = Self { length: 1e-3, angle: 1.0 };
        let mut has_length = false;
        let assigned = file.fields(context, "GLOBAL_UNIT_ASSIGNED_CONTEXT");
        let own = file.own_fields(context, "GLOBAL_UNIT_ASSIGNED_CONTEXT");
        let list = own.or(assigned).map(|fields| fields.all_references());
        for unit in list.unwrap_or_default() {
            let Some(factor) = factor(file, unit, 0) else { continue };
            if file.is(unit, "LENGTH_UNIT") {
                units.length = factor;
                has_length = true;
            } else if file.is(unit, "PLANE_ANGLE_UNIT") {
                units.angle = factor;
            }
        }
        (units, has_length)
    }
}

/// Multiple of the unit of SI. `None` if it is not above zero or not given.
fn factor(file: &File, unit: u64, depth: usize) -> Option<f64> {
    if depth > 8 {
        return None;
    }
    let factor = if let Some(si) = file.own_fields(unit, "SI_UNIT") {
        prefix(si.word(0))
    } else {
        let conversion = file.own_fields(unit, "CONVERSION_BASED_UNIT")?;
        let measure = conversion.optional_reference(1)?;
        let kinds = ["LENGTH_MEASURE_WITH_UNIT", "PLANE_ANGLE_MEASURE_WITH_UNIT", "MEASURE_WITH_UNIT"];
        let measure = kinds.iter().find_map(|kind| file.fields(measure, kind))?;
        measure.real(0).ok()? * self::factor(file, measure.optional_reference(1)?, depth + 1)?
    };
    (factor > 0.0 && factor.is_finite()).then_some(factor)
}

fn prefix(word: &str) -> f64 {
    match word {
        "EXA" => 1e18,
        "PETA" => 1e15,
        "TERA" => 1e12,
        "GIGA" => 1e9,
        "MEGA" => 1e6,
        "KILO" => 1e3,
        "HECTO" => 1e2,
        "DECA" => 1e1,
        "DECI" => 1e-1,
        "CENTI" => 1e-2,
        "MILLI" => 1e-3,
        "MICRO" => 1e-6,
        "NANO" => 1e-9,
        "PICO" => 1e-12,
        "FEMTO" => 1e-15,
        "ATTO" => 1e-18,
        _ => 1.0,
    }
}
