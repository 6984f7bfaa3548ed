//! Units, placements, names, colours, what is left out.

use super::integrate::{assert_near, totals};
use super::read;
use super::text::{Text, list};
use crate::model::Assembly;
use glam::{DQuat, DVec3, Vec3};
use std::f64::consts::FRAC_PI_2;

/// Places of the corners of a box of this size in the world, by its instance.
fn corner(assembly: &Assembly, instance: usize, at: DVec3) -> DVec3 {
    assembly.instances[instance].world_from_part.transform_point3(at)
}

fn assert_at(found: DVec3, expected: DVec3) {
    assert!(found.distance(expected) < 1e-12, "{found} instead of {expected}");
}

#[test]
fn two_instances_in_inches() {
    let mut text = Text::new();
    let context = text.inches();
    let (solid, _) = text.cuboid(DVec3::new(1.0, 2.0, 3.0), DQuat::IDENTITY, DVec3::ZERO);
    let origin = text.frame(DVec3::ZERO, DVec3::Z, DVec3::X);
    let child = text.product("block", &[solid, origin], context);
    // One moved; one turned by a quarter about z and moved.
    let moved = text.frame(DVec3::new(10.0, 0.0, 0.0), DVec3::Z, DVec3::X);
    let turned = text.frame(DVec3::new(0.0, 20.0, 5.0), DVec3::Z, DVec3::Y);
    let parent = text.product("bench", &[origin, moved, turned], context);
    text.occurrence("left", parent, child, origin, moved);
    text.occurrence("", parent, child, origin, turned);
    let assembly = read(&text.finish());
    assert_eq!(assembly.parts.len(), 1);
    let paths: Vec<_> = assembly.instances.iter().map(|instance| instance.path.join("/")).collect();
    assert_eq!(paths, ["bench/left", "bench/block"]);
    let inch = 0.0254;
    let [area, volume] = totals(&assembly.parts[0]);
    assert_near(area, 22.0 * inch * inch, 1e-9);
    assert_near(volume, 6.0 * inch * inch * inch, 1e-9);
    // z up in the file, y up in the world: (x, y, z) becomes (x, z, −y).
    let far = inch * DVec3::new(1.0, 2.0, 3.0);
    assert_at(corner(&assembly, 0, far), inch * DVec3::new(11.0, 3.0, -2.0));
    // (1, 2, 3) turned: (−2, 1, 3); moved: (−2, 21, 8).
    assert_at(corner(&assembly, 1, far), inch * DVec3::new(-2.0, 8.0, -21.0));
}

#[test]
fn nested_assemblies_and_mapped_items() {
    let mut text = Text::new();
    let context = text.millimetres();
    let (solid, _) = text.cuboid(DVec3::splat(10.0), DQuat::IDENTITY, DVec3::ZERO);
    let origin = text.frame(DVec3::ZERO, DVec3::Z, DVec3::X);
    let leaf = text.product("leaf", &[solid], context);
    let up = text.frame(DVec3::new(0.0, 0.0, 100.0), DVec3::Z, DVec3::X);
    let middle = text.product("middle", &[], context);
    text.occurrence("on", middle, leaf, origin, up);
    // The relationship written the other way round: the parent first.
    let root = text.product("root", &[], context);
    let side = text.frame(DVec3::new(50.0, 0.0, 0.0), DVec3::Z, DVec3::X);
    text.occurrence("beside", [root[0], middle[1]], [middle[0], root[1]], side, origin);
    // A mapped item, twice as large.
    let map = text.add(format!("REPRESENTATION_MAP(#{origin},#{})", leaf[1]));
    let place = text.point(DVec3::new(0.0, 7.0, 0.0));
    let target = text.add(format!("CARTESIAN_TRANSFORMATION_OPERATOR_3D('','','',$,$,#{place},2.,$)"));
    let item = text.add(format!("MAPPED_ITEM('copy',#{map},#{target})"));
    text.product("mapped", &[item], context);
    let assembly = read(&text.finish());
    assert_eq!(assembly.notes, Vec::<String>::new());
    let paths: Vec<_> = assembly.instances.iter().map(|instance| instance.path.join("/")).collect();
    assert_eq!(paths, ["root/beside/on", "mapped/copy"]);
    assert_eq!(assembly.parts.len(), 1);
    assert_at(corner(&assembly, 0, DVec3::ZERO), DVec3::new(0.05, 0.1, 0.0));
    assert_at(corner(&assembly, 1, DVec3::splat(0.01)), DVec3::new(0.02, 0.02, -0.027));
}

#[test]
fn the_innermost_colour_counts() {
    let mut text = Text::new();
    let context = text.millimetres();
    let (solid, faces) = text.cuboid(DVec3::splat(10.0), DQuat::IDENTITY, DVec3::ZERO);
    let style = |text: &mut Text, colour: &str, item: u64, overriding: bool| {
        let colour = text.add(colour);
        let fill = text.add(format!("FILL_AREA_STYLE_COLOUR('',#{colour})"));
        let fill = text.add(format!("FILL_AREA_STYLE('',(#{fill}))"));
        let fill = text.add(format!("SURFACE_STYLE_FILL_AREA(#{fill})"));
        let side = text.add(format!("SURFACE_SIDE_STYLE('',(#{fill}))"));
        let usage = text.add(format!("SURFACE_STYLE_USAGE(.BOTH.,#{side})"));
        let style = text.add(format!("PRESENTATION_STYLE_ASSIGNMENT((#{usage}))"));
        if overriding {
            text.add(format!("OVER_RIDING_STYLED_ITEM('',(#{style}),#{item},#{item})"));
        } else {
            text.add(format!("STYLED_ITEM('',(#{style}),#{item})"));
        }
    };
    style(&mut text, "COLOUR_RGB('',0.5,0.,1.)", solid, false);
    style(&mut text, "DRAUGHTING_PRE_DEFINED_COLOUR('red')", faces[0], false);
    style(&mut text, "COLOUR_RGB('',0.,0.02,0.)", faces[1], false);
    style(&mut text, "DRAUGHTING_PRE_DEFINED_COLOUR('green')", faces[2], false);
    style(&mut text, "DRAUGHTING_PRE_DEFINED_COLOUR('blue')", faces[2], true);
    text.product("block", &[solid], context);
    let part = &read(&text.finish()).parts[0];
    let colour = |face: usize| part.faces[face].1.unwrap();
    let near = |a: Vec3, b: Vec3| assert!(a.distance(b) < 1e-6, "{a} instead of {b}");
    near(colour(0), Vec3::X);
    near(colour(1), Vec3::new(0.0, 0.02, 0.0));
    near(colour(2), Vec3::Z);
    near(colour(3), Vec3::new(0.5, 0.0, 1.0));
}

#[test]
fn surfaces_that_are_not_read_are_counted_and_named() {
    let mut text = Text::new();
    let context = text.millimetres();
    let (_, faces) = text.cuboid(DVec3::splat(10.0), DQuat::IDENTITY, DVec3::ZERO);
    let frame = text.frame(DVec3::ZERO, DVec3::Z, DVec3::X);
    let plane = text.add(format!("PLANE('',#{frame})"));
    let offset = text.add(format!("OFFSET_SURFACE('',#{plane},1.,.F.)"));
    let edge = text.circle(DVec3::Z, DVec3::Z, DVec3::X, 2.0);
    let bound = text.bound(&[(edge, true)]);
    let unread = [text.face(offset, &[bound], true), text.face(offset, &[bound], true)];
    let all: Vec<u64> = faces.into_iter().chain(unread).collect();
    let solid = text.solid("", &all);
    let mesh = text.add("TESSELLATED_SOLID('',(),$)");
    text.product("housing", &[solid, mesh], context);
    let assembly = read(&text.finish());
    assert_eq!(assembly.parts[0].faces.len(), 6);
    assert!(!assembly.parts[0].is_closed);
    let notes = [
        "2 faces of \"housing\": offset surfaces are not read",
        "1 item of \"housing\": tessellated solids are not read",
        // The box by itself.
        "1 body of the file: it belongs to no product's shape and is left out",
    ];
    for note in notes {
        assert!(assembly.notes.iter().any(|found| found == note), "{:?}", assembly.notes);
    }
    assert_eq!(assembly.notes.len(), notes.len(), "{:?}", assembly.notes);
}

#[test]
fn bodies_without_products_are_read() {
    let mut text = Text::new();
    text.cuboid(DVec3::splat(10.0), DQuat::from_rotation_x(FRAC_PI_2), DVec3::ZERO);
    let assembly = read(&text.finish());
    assert_eq!(assembly.parts[0].name, "box");
    assert_eq!(assembly.instances[0].path, ["box"]);
    assert!(assembly.notes[0].contains("millimetres are assumed"));
}

#[test]
fn open_shells_and_voids() {
    let mut text = Text::new();
    let context = text.millimetres();
    let (_, outer) = text.cuboid(DVec3::splat(30.0), DQuat::IDENTITY, DVec3::ZERO);
    let (_, inner) = text.cuboid(DVec3::splat(10.0), DQuat::IDENTITY, DVec3::splat(10.0));
    let [outer, inner] = [outer, inner].map(|faces| text.add(format!("CLOSED_SHELL('',{})", list(&faces))));
    let void = text.add(format!("ORIENTED_CLOSED_SHELL('',*,#{inner},.F.)"));
    let hollow = text.add(format!("BREP_WITH_VOIDS('',#{outer},(#{void}))"));
    let (_, faces) = text.cuboid(DVec3::splat(10.0), DQuat::IDENTITY, DVec3::ZERO);
    let open = text.add(format!("OPEN_SHELL('',{})", list(&faces[..5])));
    let open = text.add(format!("SHELL_BASED_SURFACE_MODEL('',(#{open}))"));
    text.product("hollow", &[hollow], context);
    text.product("open", &[open], context);
    let assembly = read(&text.finish());
    super::assert_closed(text.finish().as_bytes());
    let [hollow, open] = &assembly.parts[..] else { panic!() };
    assert!(hollow.is_closed && !open.is_closed);
    let [area, volume] = totals(hollow);
    assert_near(area, 6.0 * (9e-4 + 1e-4), 1e-9);
    assert_near(volume, 26e-6, 1e-9);
    assert_near(totals(open)[0], 5e-4, 1e-9);
}
