// Λ of Smith's masking of microfacets, of a direction with this cosine to the normal; as shared/src/ggx.rs.

fn smith_lambda(alpha: f32, cosine: f32) -> f32 {
    let c2 = cosine * cosine;
    return 0.5 * (sqrt(1.0 + alpha * alpha * max(1.0 - c2, 0.0) / max(c2, 1e-12)) - 1.0);
}
