//! `cargo xtask light-kinds`: the kinds of light as TypeScript, from their table in shared/src/light/kinds.rs.

use crate::process;
use anyhow::{Context, Result};
use rebounce_shared::light::{Absent, Field, INTENSITY, KINDS, LightDescription, LightKind, NUMBERS, SIZE};
use std::fmt::Write;

/// The written file.
const FILE: &str = "web/src/wire/light-kinds.ts";

/// The file's beginning: the form of the table.
const HEAD: &str = r#"/** The kinds of light and their fields. `cargo xtask light-kinds` writes this file from shared/src/light/kinds.rs. */

import type { Named, Triple } from "./shot.js";
"#;

/// Types of the table.
const TYPES: &str = r#"
/** A field of lights. */
export interface Field {
  name: string;
  /** What the panel calls it. */
  row: string;
  /** Where its first number is in a light's list of numbers. */
  at: number;
  /** How many numbers it has; none of a text. */
  width: 0 | 1 | 3;
  /** What it is when absent, NaN where a light may be without; it must be there when this is absent. */
  absent?: number | Triple;
  /** Of a new light; what is absent follows from where it stands, or is the default. */
  fresh?: number | Triple;
  /** The greatest number; none when absent. */
  max?: number;
}

/** A kind of light. */
export interface Kind {
  /** What lights without a name are called. */
  called: string;
  /** What the list calls the kind. */
  listed: string;
  /** Units of the intensity; the first is that of the member. */
  units: readonly string[];
  /** Whether a new one can stand anywhere in a scene. */
  lamp: boolean;
  /** In the order of links. */
  fields: readonly Field[];
}
"#;

/// Writes the file.
///
/// # Errors
/// If the file cannot be written.
pub fn run() -> Result<()> {
    let path = process::root().join(FILE);
    std::fs::write(&path, text()).with_context(|| path.display().to_string())?;
    println!("wrote {}", path.display());
    Ok(())
}

/// Text of the file.
fn text() -> String {
    let mut out = HEAD.to_owned();
    KINDS.iter().for_each(|kind| interface(&mut out, kind));
    let all: Vec<_> = KINDS.iter().map(|kind| format!("{}Light", kind.variant)).collect();
    let _ = writeln!(out, "\n/** Any light. */\nexport type Light = {};", all.join(" | "));
    out += TYPES;
    let _ = writeln!(out, "\n/** Numbers of a light: its kind's place in the table, then its fields. */");
    let _ = writeln!(out, "export const LIGHT = {NUMBERS};");
    let _ = writeln!(out, "/** Where the size is among them, whatever the kind calls it. */");
    let _ = writeln!(out, "export const SIZE = {};\n", SIZE.at);
    // Fields of a common name have the first kind's name besides, but for the first.
    let mut fields: Vec<(&Field, String)> = Vec::new();
    for (kind, (field, _)) in KINDS.iter().flat_map(|kind| kind.fields.iter().map(move |field| (kind, field)))
    {
        if fields.iter().all(|(other, _)| *other != *field) {
            let is_taken = fields.iter().any(|(_, name)| name == field.name);
            let name = if is_taken { format!("{}_{}", kind.name, field.name) } else { field.name.to_owned() };
            let _ = writeln!(out, "const {name}: Field = {};", object(field));
            fields.push((field, name));
        }
    }
    let _ = writeln!(out, "\n/** The kinds in the order of their numbers. */");
    let _ = writeln!(out, "export const KINDS: Record<Light[\"type\"], Kind> = {{");
    for (kind, LightDescription { name, called, listed, units, fields: own, .. }) in (0..).zip(&KINDS) {
        let named =
            |field: &Field| fields.iter().find(|(other, _)| *other == field).map(|(_, name)| name.as_str());
        let names: Vec<_> = own.iter().filter_map(|(field, _)| named(field)).collect();
        let names = names.join(", ");
        let _ = writeln!(out, "  {name}: {{");
        let _ = writeln!(out, "    called: {called:?},\n    listed: {listed:?},\n    units: {units:?},");
        let lamp = kind < LightKind::Environment as u32;
        let _ = writeln!(out, "    lamp: {lamp},");
        let _ = writeln!(out, "    fields: [{names}],\n  }},");
    }
    out + "};\n"
}

/// The type of a kind's lights.
fn interface(out: &mut String, kind: &LightDescription) {
    let LightDescription { variant, name, doc, fields, .. } = kind;
    let _ =
        writeln!(out, "\n/**{doc} */\nexport interface {variant}Light extends Named {{\n  type: {name:?};");
    for (field, doc) in *fields {
        // The page's lights always have an intensity, even those that SHOT.json may have without.
        let is_there = field.absent == Absent::Refused || field.at == INTENSITY.at;
        let optional = if is_there { "" } else { "?" };
        let numbers = ["string", "number", "", "Triple"][field.width];
        let _ = writeln!(out, "  /**{doc} */\n  {}{optional}: {numbers};", field.name);
    }
    *out += "}\n";
}

/// A field's description.
fn object(field: &Field) -> String {
    let Field { name, row, at, width, .. } = field;
    let mut out = format!("{{ name: {name:?}, row: {row:?}, at: {at}, width: {width}");
    let _ = match field.absent {
        Absent::Refused => Ok(()),
        Absent::Nothing => write!(out, ", absent: NaN"),
        Absent::Number(number) => write!(out, ", absent: {number}"),
        Absent::Vector(vector) => write!(out, ", absent: {}", list(&vector)),
    };
    let _ = match field.fresh {
        None => Ok(()),
        Some([number]) => write!(out, ", fresh: {number}"),
        Some(vector) => write!(out, ", fresh: {}", list(vector)),
    };
    let _ = match field.range.most() {
        Some(most) if field.width == 1 => write!(out, ", max: {most}"),
        _ => Ok(()),
    };
    out + " }"
}

fn list(numbers: &[f64]) -> String {
    let numbers: Vec<_> = numbers.iter().map(f64::to_string).collect();
    format!("[{}]", numbers.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_has_the_table_of_today() {
        let path = process::root().join(FILE);
        let written = std::fs::read_to_string(path).unwrap_or_default();
        assert!(written == text(), "{FILE} differs from the table: run `cargo xtask light-kinds`");
    }
}
