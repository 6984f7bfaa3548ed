// Reconstruction groups: functions cover the surfaces of their own group alone.

// Bits of a function's number in an entry of a list; above is its group.
const FUNCTION_BITS = 22u;

fn function_of(entry: u32) -> u32 {
    return entry & ((1u << FUNCTION_BITS) - 1u);
}

fn belongs(entry: u32, group: u32) -> bool {
    return entry >> FUNCTION_BITS == group;
}

// The group of a material.
fn group_of(material: u32) -> u32 {
    return lookup[arrayLength(&lookup) - 1u - material];
}
