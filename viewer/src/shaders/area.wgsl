// Area lights: irradiance without occluders, as shared/src/light/area.rs; where their highlights lie; how they look.

const DISK_CORNERS = 16u;

fn is_area(light: Light) -> bool {
    return light.kind >= RECTANGLE;
}

// The corner `i` of a rectangle, or of the polygon of a disk's area, relative to the middle.
fn area_corner(light: Light, i: u32) -> vec3f {
    let right = cross(light.up, light.direction);
    if light.kind == RECTANGLE {
        let sign = select(vec2f(-0.5), vec2f(0.5), vec2<bool>(((i + 1u) & 2u) == 0u, (i & 2u) == 0u));
        return right * (light.extent.x * sign.x) + light.up * (light.extent.y * sign.y);
    }
    let step = 6.28318530717959 / f32(DISK_CORNERS);
    let angle = f32(i) * step;
    return light.size * sqrt(step / sin(step)) * (right * cos(angle) + light.up * sin(angle));
}

// The angle of an edge as seen, times the share of the edge's plane's normal along `normal`.
fn area_edge(a: vec3f, b: vec3f, normal: vec3f) -> f32 {
    let across = cross(a, b);
    let sine = length(across);
    return select(0.0, atan2(sine, dot(a, b)) * dot(across, normal) / sine, sine > 0.0);
}

// Lambert's sum over the edges of the polygon above the horizon.
fn area_polygon(light: Light, offset: vec3f, normal: vec3f) -> f32 {
    let corners = select(DISK_CORNERS, 4u, light.kind == RECTANGLE);
    var sum = 0.0;
    // Where the polygon dips below the horizon and where it comes up again.
    var down = vec3f(0.0);
    var up = vec3f(0.0);
    var is_cut = false;
    var a = offset + area_corner(light, 0u);
    var height = dot(normal, a);
    for (var i = 1u; i <= corners; i++) {
        let b = offset + area_corner(light, i);
        let next = dot(normal, b);
        if height > 0.0 || next > 0.0 {
            let crossing = a + (b - a) * (height / (height - next));
            var first = a;
            var last = b;
            if height <= 0.0 {
                first = crossing;
                up = crossing;
            }
            if next <= 0.0 {
                last = crossing;
                down = crossing;
                is_cut = true;
            }
            sum += area_edge(first, last, normal);
        }
        a = b;
        height = next;
    }
    if is_cut {
        sum += area_edge(down, up, normal);
    }
    return 0.5 * abs(sum);
}

fn area_sphere(offset: vec3f, radius: f32, normal: vec3f) -> f32 {
    let h = length(offset) / radius;
    let cosine = dot(normal, offset) / (h * radius);
    let square = h * h;
    if h <= 1.0 || abs(cosine * h) >= 1.0 {
        return select(0.0, PI * max(cosine, 0.0) / square, h > 1.0);
    }
    let x = sqrt(square - 1.0);
    let sine = sqrt(1.0 - cosine * cosine);
    let y = clamp(-x * cosine / sine, -1.0, 1.0);
    let across = sine * sqrt(1.0 - y * y);
    return max((cosine * acos(y) - x * across) / square + atan(across / x), 0.0);
}

// Irradiance on a surface, as a share of the light's radiance: the projected solid angle that it fills above the horizon.
fn projected_solid_angle(light: Light, position: vec3f, normal: vec3f) -> f32 {
    let offset = light.position - position;
    if light.kind == SPHERE {
        return area_sphere(offset, light.size, normal);
    }
    if dot(offset, light.direction) >= 0.0 {
        return 0.0;
    }
    return area_polygon(light, offset, normal);
}

// The place of a light's plane that a ray meets, or of a sphere's middle plane that it is nearest, relative to the middle.
fn area_met(light: Light, offset: vec3f, ray: vec3f) -> vec3f {
    let along = dot(ray, light.direction);
    // A ray that heads away from the plane nears it sideways.
    let far = select(length(offset), dot(offset, light.direction) / along, dot(offset, light.direction) * along > 0.0);
    return ray * select(far, max(dot(offset, ray), 0.0), light.kind == SPHERE) - offset;
}

// The place of the light that is nearest one of its plane, relative to the middle.
fn area_nearest(light: Light, place: vec3f) -> vec3f {
    if light.kind == RECTANGLE {
        let right = cross(light.up, light.direction);
        let at = clamp(vec2f(dot(place, right), dot(place, light.up)), -0.5 * light.extent, 0.5 * light.extent);
        return at.x * right + at.y * light.up;
    }
    return place * min(1.0, light.size / max(length(place), 1e-20));
}

// Unit vector to the place of an area light that is nearest a mirror's ray (Karis 2013, Real Shading in Unreal Engine 4).
fn area_highlight(light: Light, position: vec3f, ray: vec3f) -> vec3f {
    let offset = light.position - position;
    return normalize(offset + area_nearest(light, area_met(light, offset, ray)));
}

// Distance at which a ray meets a light's surface; 0 where it does not. `ray` is a unit vector.
fn area_distance(light: Light, origin: vec3f, ray: vec3f) -> f32 {
    let offset = light.position - origin;
    let place = area_met(light, offset, ray);
    let distance = dot(offset + place, ray);
    if light.kind == SPHERE {
        let half = light.size * light.size - dot(place, place);
        return select(0.0, max(distance - sqrt(max(half, 0.0)), 0.0), half > 0.0);
    }
    // Rays that miss the plane are farther from it than any rounding.
    let off = place - area_nearest(light, place);
    return select(0.0, distance, dot(off, off) < 1e-6 * light.size * light.size);
}
