//! Texts that are wrong or mean harm.

use super::text::{Text, list};
use crate::step::{StepError, read};
use glam::{DQuat, DVec3};

#[test]
fn what_is_no_step_file_is_refused() {
    for bytes in [&b""[..], b"solid ascii", b"ISO-10303-21;", &[0xff; 64]] {
        assert!(matches!(read(bytes), Err(StepError::Syntax(_))));
    }
    assert_eq!(read(Text::new().finish().as_bytes()), Err(StepError::Empty));
}

#[test]
fn numbers_beyond_double_precision_are_refused() {
    let mut text = Text::new();
    text.add("CARTESIAN_POINT('',(0.,1.E999,0.))");
    let Err(StepError::Syntax(why)) = read(text.finish().as_bytes()) else { panic!() };
    assert!(why.contains("out of range"), "{why}");
}

#[test]
fn an_assembly_within_itself_is_refused() {
    let mut text = Text::new();
    let context = text.millimetres();
    let origin = text.frame(DVec3::ZERO, DVec3::Z, DVec3::X);
    let [a, b] = ["a", "b"].map(|name| text.product(name, &[], context));
    text.occurrence("", a, b, origin, origin);
    text.occurrence("", b, a, origin, origin);
    assert!(matches!(read(text.finish().as_bytes()), Err(StepError::Cycle(_))));
}

#[test]
fn a_mapped_item_within_itself_is_refused() {
    let mut text = Text::new();
    let context = text.millimetres();
    let origin = text.frame(DVec3::ZERO, DVec3::Z, DVec3::X);
    // The numbers that the records will have.
    let own = origin + 3;
    let map = text.add(format!("REPRESENTATION_MAP(#{origin},#{own})"));
    let item = text.add(format!("MAPPED_ITEM('',#{map},#{origin})"));
    assert_eq!(text.add(format!("SHAPE_REPRESENTATION('',(#{item},#{item}),#{context})")), own);
    let [definition, _] = text.product("a", &[item], context);
    let shape = text.add(format!("PRODUCT_DEFINITION_SHAPE('','',#{definition})"));
    text.add(format!("SHAPE_DEFINITION_REPRESENTATION(#{shape},#{own})"));
    assert!(matches!(read(text.finish().as_bytes()), Err(StepError::TooDeep(_) | StepError::TooLarge)));
}

/// Thirty levels of two occurrences each: 2³⁰ boxes.
#[test]
fn an_assembly_that_doubles_at_every_level_is_refused() {
    let mut text = Text::new();
    let context = text.millimetres();
    let (solid, _) = text.cuboid(DVec3::splat(1.0), DQuat::IDENTITY, DVec3::ZERO);
    let origin = text.frame(DVec3::ZERO, DVec3::Z, DVec3::X);
    let mut below = text.product("leaf", &[solid], context);
    for _ in 0..30 {
        let level = text.product("level", &[], context);
        text.occurrence("", level, below, origin, origin);
        text.occurrence("", level, below, origin, origin);
        below = level;
    }
    assert_eq!(read(text.finish().as_bytes()), Err(StepError::TooLarge));
}

/// Every record in turn loses a reference, changes a number, or is lost: no panic, whatever comes of it.
#[test]
fn damaged_files_do_not_panic() {
    let mut text = Text::new();
    let context = text.millimetres();
    let edge = text.circle(DVec3::ZERO, DVec3::Z, DVec3::X, 30.0);
    let frame = text.frame(DVec3::ZERO, -DVec3::Z, DVec3::X);
    let cone = text.add(format!("CONICAL_SURFACE('',#{frame},30.,0.6)"));
    let bound = text.bound(&[(edge, true)]);
    let cone = text.face(cone, &[bound], true);
    let poles =
        [[0.0, 0.0], [0.0, 9.0], [9.0, 0.0], [9.0, 9.0]].map(|[x, y]| text.point(DVec3::new(x, y, x * y)));
    let [a, b, c, d] = poles;
    let patch = text.add(format!(
        "B_SPLINE_SURFACE_WITH_KNOTS('',1,1,((#{a},#{b}),(#{c},#{d})),.UNSPECIFIED.,.F.,.F.,.F.,(2,2),(2,2),\
         (0.,1.),(0.,1.),.UNSPECIFIED.)"
    ));
    let patch = text.face(patch, &[], true);
    let (_, mut faces) = text.cuboid(DVec3::splat(9.0), DQuat::IDENTITY, DVec3::ZERO);
    faces.extend([cone, patch]);
    let solid = text.solid("", &faces);
    text.product("thing", &[solid], context);
    let whole = text.finish();
    assert_eq!(read(whole.as_bytes()).unwrap().parts[0].faces.len(), 8);
    let lines: Vec<&str> = whole.lines().collect();
    for at in 0..lines.len() {
        for damage in 0..7 {
            let line = lines[at];
            let damaged = match damage {
                0 => String::new(),
                1 => line.replacen(",#", ",#9", 1),
                2 => line.replacen(",#", ",$,#", 1),
                3 => line.replace("1.", "1.E300").replace("0.", "0.E0"),
                4 => line.replace("9.", "-1.E-300").replace("30.", "0."),
                5 => line.replacen("(2,2)", "(2,99999999)", 1).replacen(",1,", ",0,", 1),
                _ => line.replacen(",#", ",#1", 1),
            };
            let mut lines = lines.clone();
            lines[at] = &damaged;
            let _ = read(lines.join("\n").as_bytes());
        }
    }
}

/// What a small honest file may have: two hundred racks of five hundred screws each.
#[test]
fn a_hundred_thousand_occurrences_are_read() {
    let mut text = Text::new();
    let context = text.millimetres();
    let (solid, _) = text.cuboid(DVec3::splat(1.0), DQuat::IDENTITY, DVec3::ZERO);
    let origin = text.frame(DVec3::ZERO, DVec3::Z, DVec3::X);
    let screw = text.product("screw", &[solid], context);
    let rack = text.product("rack", &[], context);
    let hall = text.product("hall", &[], context);
    (0..500).for_each(|_| text.occurrence("", rack, screw, origin, origin));
    (0..200).for_each(|_| text.occurrence("", hall, rack, origin, origin));
    assert_eq!(read(text.finish().as_bytes()).unwrap().instances.len(), 100_000);
}

/// A dozen faces whose edges never settle on an extruded spline with points far away: not a second each, but refused.
#[test]
fn edges_that_wander_on_a_spline_cost_what_they_take() {
    for along in [DVec3::Z, DVec3::new(20.0, 0.0, 1.0)] {
        assert_eq!(read(wandering(along).as_bytes()), Err(StepError::TooLarge));
    }
}

fn wandering(along: DVec3) -> String {
    let mut text = Text::new();
    let context = text.millimetres();
    let places = [
        [20.0, 0.0, 0.0],
        [20.0, 20.0, 0.0],
        [0.0, 20.0, 0.0],
        [-20.0, 20.0, 9e15],
        [-20.0, 0.0, 0.0],
        [-20.0, -20.0, 0.0],
        [0.0, -20.0, 0.0],
        [20.0, -20.0, 0.0],
        [4e9, 0.0, 0.0],
    ];
    let poles = places.map(|place| text.point(DVec3::from_array(place)));
    let spline = text.add(format!(
        "( BOUNDED_CURVE() B_SPLINE_CURVE(2,{},.UNSPECIFIED.,.F.,.F.) \
         B_SPLINE_CURVE_WITH_KNOTS((3,2,2,2,3),(0.,1.,2.,3.,4.),.UNSPECIFIED.) CURVE() \
         GEOMETRIC_REPRESENTATION_ITEM() RATIONAL_B_SPLINE_CURVE((1.,0.7,1.,0.7,1.,0.7,1.,0.7,1.)) \
         REPRESENTATION_ITEM('') )",
        list(&poles)
    ));
    let up = text.direction(along);
    let up = text.add(format!("VECTOR('',#{up},10.)"));
    let surface = text.add(format!("SURFACE_OF_LINEAR_EXTRUSION('',#{spline},#{up})"));
    let edges = [0.0, 50.0].map(|z| text.circle(DVec3::Z * z, DVec3::Z, DVec3::new(0.6, -0.8, 0.0), 20.0));
    let bounds = [text.bound(&[(edges[0], true)]), text.bound(&[(edges[1], false)])];
    let faces: Vec<u64> = (0..12).map(|_| text.face(surface, &bounds, true)).collect();
    let solid = text.solid("", &faces);
    text.product("tin", &[solid], context);
    text.finish()
}
