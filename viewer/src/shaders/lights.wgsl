// Lights in scene-local space and what of them reaches a point; as shared/src/light/source.rs.

const POINT = 0u;
const SPOT = 1u;
const DIRECTIONAL = 2u;
const RECTANGLE = 3u;
const DISK = 4u;
const SPHERE = 5u;

const PI = 3.14159265358979;

struct Light {
    // First layer of the shadow map, and how many: 1, 6 for a cube, 2 for
    // a directional light in a scene far larger than its detail.
    layer: u32,
    layers: u32,
    // Width of a shadow-map texel at distance 1; not used for a directional light.
    texel: f32,
    // Change of the shadow map's depth per unit of distance; directional lights only.
    depth_scale: f32,
    // From here as LightSource. Of a directional light, x is the first matrix of its own cascades, y that of all.
    position: vec3f,
    kind: u32,
    // The way the light travels.
    direction: vec3f,
    cone_scale: f32,
    intensity: vec3f,
    cone_offset: f32,
    cos_outer: f32,
    // Radius, of a rectangle that of a disk of its area; of a directional light, tangent of the angle that its disc's
    // radius spans. 0 for a point.
    size: f32,
    // Of a rectangle, width and height, and the unit vector along the height; of a disk, of a square around it.
    extent: vec2f,
    up: vec3f,
}

struct Incident {
    // Unit vector to the light.
    to_light: vec3f,
    // Irradiance, were nothing in between: on a surface that faces the light, or on the surface in question.
    irradiance: vec3f,
    // Irradiance as a share of the light's radiance; 0 of lights without a surface.
    solid: f32,
}

// Whether any of the light may reach a place within `radius` of `position` on a surface with this unit normal.
fn may_reach(light: Light, position: vec3f, normal: vec3f, radius: f32) -> bool {
    if light.kind == DIRECTIONAL {
        return dot(normal, light.direction) < 0.0;
    }
    let offset = light.position - position;
    let distance = length(offset);
    if light.kind > DIRECTIONAL {
        let reach = radius + max(light.size, 0.5 * length(light.extent));
        return dot(normal, offset) > -reach && (light.kind == SPHERE || dot(light.direction, offset) < radius);
    }
    // The sine of the angle by which the way to the light may differ; past it, nothing is certain.
    let spread = radius / max(distance, 1e-20);
    if spread >= 0.5 {
        return true;
    }
    let to_light = offset / distance;
    let margin = 1.1 * spread;
    return dot(normal, to_light) + margin > 0.0
        && (-dot(to_light, light.direction) + margin) * light.cone_scale + light.cone_offset > 0.0;
}

// From a light without a surface.
fn incident(light: Light, position: vec3f) -> Incident {
    if light.kind == DIRECTIONAL {
        return Incident(-light.direction, light.intensity, 0.0);
    }
    let offset = light.position - position;
    let distance_squared = dot(offset, offset);
    if distance_squared <= 0.0 {
        return Incident(vec3f(0.0, 1.0, 0.0), vec3f(0.0), 0.0);
    }
    let to_light = offset * inverseSqrt(distance_squared);
    let ramp = saturate(-dot(to_light, light.direction) * light.cone_scale + light.cone_offset);
    return Incident(to_light, light.intensity * (ramp * ramp / distance_squared), 0.0);
}
