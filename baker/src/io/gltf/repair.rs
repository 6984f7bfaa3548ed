//! Repair of JSON that the `gltf` crate refuses to parse although the meaning is clear.
//!
//! * [`mend`] – exporters' notations for an absent member and for an index;
//! * [`complete`] – members that the crate requires but that may be absent.

use serde_json::{Value, json};

/// Optional index members; exporters write −1 for an absent index.
const OPTIONAL: [&str; 12] = [
    "bufferView",
    "camera",
    "indices",
    "inverseBindMatrices",
    "material",
    "mesh",
    "node",
    "sampler",
    "scene",
    "skeleton",
    "skin",
    "source",
];
/// Required index members.
const REQUIRED: [&str; 4] = ["buffer", "index", "input", "output"];
/// Members that are lists of node indices.
const LISTS: [&str; 3] = ["children", "joints", "nodes"];
/// 2^53: integers up to this bound are exact in 64-bit floats.
const EXACT: f64 = 9_007_199_254_740_992.0;

/// Removes members that are null or the index −1, and converts integral floats to integers. Leaves application data
/// (`extras`) unchanged.
pub(super) fn mend(root: &mut Value) {
    walk("", root);
}

fn walk(name: &str, value: &mut Value) {
    match value {
        Value::Object(members) => {
            members.retain(|key, member| key == "extras" || !is_none(name, key, member));
            for (key, member) in members.iter_mut().filter(|(key, _)| *key != "extras") {
                walk(key, member);
                let key = key.as_str();
                if name == "attributes" || OPTIONAL.contains(&key) || REQUIRED.contains(&key) {
                    bound(member);
                }
            }
        }
        Value::Array(list) => {
            if list.iter().any(Value::is_object) {
                // Indices count null elements too, so an empty object replaces null.
                list.iter_mut().filter(|element| element.is_null()).for_each(|e| *e = json!({}));
            } else if LISTS.contains(&name) {
                list.retain(|element| !element.is_null() && !is_minus_one(element));
                list.iter_mut().for_each(bound);
            }
            list.iter_mut().for_each(|element| walk("", element));
        }
        Value::Number(number) => {
            // An integral float becomes an integer: 3.0 is the index 3. Except −0.0, which would lose the sign.
            let whole = |x: &f64| x.fract() == 0.0 && x.abs() <= EXACT && (*x != 0.0 || x.is_sign_positive());
            if let Some(x) = number.as_f64().filter(whole).filter(|_| number.is_f64()) {
                *value = json!(x as i64);
            }
        }
        _ => {}
    }
}

/// Whether a member of the object `of` means absence: null, or the index −1.
fn is_none(of: &str, key: &str, member: &Value) -> bool {
    let inner = |index: &str| member.get(index).is_some_and(is_minus_one);
    member.is_null()
        || (of == "attributes" || OPTIONAL.contains(&key)) && is_minus_one(member)
        || key.ends_with("Texture") && inner("index")
        || key == "KHR_lights_punctual" && inner("light")
}

fn is_minus_one(value: &Value) -> bool {
    value.as_f64() == Some(-1.0)
}

/// Clamps an index to `u32::MAX`, an index without an element: the crate truncates indices to 32 bits.
fn bound(index: &mut Value) {
    if index.as_u64().is_some_and(|i| i > u64::from(u32::MAX)) {
        *index = json!(u32::MAX);
    }
}

/// Adds absent members that the crate requires: members replaced by an extension, members never read, and members with
/// a better error on reading.
pub(super) fn complete(root: &mut Value) {
    each(root, "scenes", |scene| add(scene, &[("nodes", json!([]))]));
    each(root, "bufferViews", |view| add(view, &[("buffer", json!(0)), ("byteLength", json!(0))]));
    each(root, "accessors", |accessor| {
        add(accessor, &[("componentType", json!(0)), ("type", json!("")), ("count", json!(0))]);
    });
    each(root, "meshes", |mesh| {
        add(mesh, &[("primitives", json!([]))]);
        each(mesh, "primitives", |primitive| add(primitive, &[("attributes", json!({}))]));
    });
    each(root, "skins", |skin| add(skin, &[("joints", json!([]))]));
    each(root, "cameras", |camera| {
        add(camera, &[("type", json!(""))]);
        let none = || json!(0);
        if let Some(lens) = camera.get_mut("perspective") {
            add(lens, &[("yfov", none()), ("znear", none())]);
        }
        if let Some(lens) = camera.get_mut("orthographic") {
            add(lens, &[("xmag", none()), ("ymag", none()), ("znear", none()), ("zfar", none())]);
        }
    });
    each(root, "animations", |animation| {
        add(animation, &[("channels", json!([])), ("samplers", json!([]))]);
        each(animation, "channels", |channel| {
            add(channel, &[("target", json!({}))]);
            if let Some(target) = channel.get_mut("target") {
                // A target of KHR_animation_pointer has no node.
                add(target, &[("node", json!(u32::MAX)), ("path", json!(""))]);
            }
        });
    });
}

/// Applies `change` to every element of an array member, if present.
fn each(of: &mut Value, list: &str, change: impl FnMut(&mut Value)) {
    of.get_mut(list).and_then(Value::as_array_mut).into_iter().flatten().for_each(change);
}

/// Adds absent members to an object.
fn add(object: &mut Value, members: &[(&str, Value)]) {
    let Some(object) = object.as_object_mut() else { return };
    for (name, value) in members {
        object.entry(*name).or_insert_with(|| value.clone());
    }
}
