//! JSON that the `gltf` crate refuses to parse though it can be read.
//!
//! * [`mend`] – the ways in which exporters say "none" or write an index;
//! * [`complete`] – members that the crate requires and that may be missing.

use serde_json::{Value, json};

/// Members that are the index of something and may be left out, or −1 where exporters mean none.
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
/// Members that are the index of something and are needed.
const REQUIRED: [&str; 4] = ["buffer", "index", "input", "output"];
/// Members that are lists of indices of nodes.
const LISTS: [&str; 3] = ["children", "joints", "nodes"];
/// The largest number below which all whole numbers are exact in 64 bits.
const EXACT: f64 = 9_007_199_254_740_992.0;

/// Takes out members that are null or an index of −1, and makes whole numbers of those written with a point. What
/// applications keep for themselves (`extras`) stays as it is.
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
                // Indices count the places in the list, empty ones too.
                list.iter_mut().filter(|element| element.is_null()).for_each(|e| *e = json!({}));
            } else if LISTS.contains(&name) {
                list.retain(|element| !element.is_null() && !is_minus_one(element));
                list.iter_mut().for_each(bound);
            }
            list.iter_mut().for_each(|element| walk("", element));
        }
        Value::Number(number) => {
            // Whole numbers are written as such: 3.0 is the index 3. The sign of −0.0 would be lost.
            let whole = |x: &f64| x.fract() == 0.0 && x.abs() <= EXACT && (*x != 0.0 || x.is_sign_positive());
            if let Some(x) = number.as_f64().filter(whole).filter(|_| number.is_f64()) {
                *value = json!(x as i64);
            }
        }
        _ => {}
    }
}

/// Whether a member of the object `of` says that there is none of its kind.
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

/// The crate cuts indices off above 32 bits: what is larger becomes the largest one, which nothing has.
fn bound(index: &mut Value) {
    if index.as_u64().is_some_and(|i| i > u64::from(u32::MAX)) {
        *index = json!(u32::MAX);
    }
}

/// Adds members that the crate requires and that may be missing, because an extension stands for them, because nothing
/// reads them, or because reading them ends in a better sentence.
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
                // What KHR_animation_pointer moves is no node.
                add(target, &[("node", json!(u32::MAX)), ("path", json!(""))]);
            }
        });
    });
}

/// Does something to each element of a list, if there is one.
fn each(of: &mut Value, list: &str, change: impl FnMut(&mut Value)) {
    of.get_mut(list).and_then(Value::as_array_mut).into_iter().flatten().for_each(change);
}

/// Adds members that an object does not have.
fn add(object: &mut Value, members: &[(&str, Value)]) {
    let Some(object) = object.as_object_mut() else { return };
    for (name, value) in members {
        object.entry(*name).or_insert_with(|| value.clone());
    }
}
