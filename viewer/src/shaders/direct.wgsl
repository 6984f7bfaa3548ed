// Direct irradiance at the points of the levels at which it is sampled: the mean over a point's
// footprint, without the samples that do not belong to its surface. What lights give that stand still is kept.

struct Choice {
    // 1: `still` goes on from what it is; 0: from zero.
    keep: u32,
    // Of the lights listed, so many first ones are added to `still`.
    kept: u32,
    count: u32,
    lights: array<u32>,
}

@group(0) @binding(1) var<storage, read> points: array<Point>;
@group(0) @binding(2) var<storage, read> choice: Choice;
@group(0) @binding(3) var<storage, read_write> still: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> irradiance: array<vec4f>;

// From the lights of a part of the list, over all samples. What is to be done is said by the loops' ends, not by branches:
// software adapters walk through branches that nobody takes.
fn direct_sum(first: u32, end: u32, p: Point) -> vec3f {
    let normal = unpack_normal(p.normal);
    let position = point_position(p);
    let on_surface = (p.cuts >> 3u) & 0xffu;
    // A point without samples is looked at itself.
    let samples = max(on_surface, 1u);
    let radius = select(0.0, p.radius, on_surface > 0u);
    var sum = vec3f(0.0);
    for (var k = first; k < end; k++) {
        let l = choice.lights[k];
        // The footprint's samples lie within 0.27 radii.
        let wanted = select(0u, samples, may_reach(lights[l], position, normal, 0.27 * p.radius));
        let of_area = select(0u, wanted, is_area(lights[l]));
        for (var rest = of_area; rest != 0u; rest &= rest - 1u) {
            sum += lit_by_area(lights[l], sampled_place(rest, position, normal, radius), normal);
        }
        for (var rest = wanted - of_area; rest != 0u; rest &= rest - 1u) {
            sum += lit(lights[l], sampled_place(rest, position, normal, radius), normal, LIFT * radius);
        }
    }
    return sum / f32(countOneBits(samples));
}

// The place of the first of these samples.
fn sampled_place(samples: u32, position: vec3f, normal: vec3f, radius: f32) -> vec3f {
    return position + footprint_offset(firstTrailingBit(samples), normal, radius);
}

@compute @workgroup_size(64)
fn direct(@builtin(global_invocation_id) id: vec3u) {
    let i = id.x + id.y * step_.threads;
    if i >= step_.count {
        return;
    }
    let p = points[i];
    var sum = vec3f(0.0);
    if choice.keep != 0u {
        sum = still[i].xyz;
    }
    if choice.keep == 0u || choice.kept > 0u {
        sum += direct_sum(0u, choice.kept, p);
        still[i] = vec4f(sum, 0.0);
    }
    irradiance[i] = vec4f(sum + direct_sum(choice.kept, choice.count, p), 0.0);
}
