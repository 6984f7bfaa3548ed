//! Light that bounces between the coarse points: the Neumann series i_j+1 = T i_j, b = Σ i_j (the report, section 6.3).
//!
//! The rays of the coarse receivers are cast once. Their rows serve every bounce.

use super::direct::GroupField;
use super::gather::ChannelRow;
use crate::basis::Relations;
use glam::Vec3;
use rayon::prelude::*;

/// Share of the first bounce's light at which the series ends.
const LEAST: f32 = 1e-4;
/// Greatest number of bounces: mirrors of light without end, of albedo 1.
const MOST: u32 = 1000;

/// Light of all bounces at the coarse points.
pub struct CoarseBounces {
    /// Sum of all bounces.
    pub total: GroupField,
    /// Sum of all bounces but the last: the light that is sent on, so that the receivers have as many bounces as asked for.
    pub sent: GroupField,
    /// Number of bounces.
    pub bounces: u32,
}

/// Adds up the bounces. `first` is the first bounce at the coarse points, `rows` those of the gathered ones; others have the
/// mean of their parents. `limit` is the number of bounces; without one the series ends where nothing is left.
pub fn coarse_bounces(
    first: GroupField,
    rows: &[Option<ChannelRow>],
    relations: &Relations,
    limit: Option<u32>,
) -> CoarseBounces {
    let groups = first.groups;
    let most = |field: &GroupField, group: usize| field.group(group).map(Vec3::element_sum).sum::<f32>();
    let least: Vec<f32> = (0..groups).map(|group| LEAST * most(&first, group)).collect();
    let mut sent = GroupField::new(rows.len(), groups);
    let (mut total, mut last, mut bounces) = (first.clone(), first, 1);
    while bounces < limit.unwrap_or(MOST) {
        let sums = rows.par_iter().map(|row| {
            let mut sums = vec![Vec3::ZERO; groups];
            for (sender, amount) in row.iter().flatten() {
                let sender = last.at(*sender as usize);
                sums.iter_mut().zip(sender).for_each(|(sum, irradiance)| *sum += *amount * *irradiance);
            }
            sums
        });
        let sums: Vec<Vec<Vec3>> = sums.collect();
        let mut next = GroupField { groups, values: sums.concat() };
        for (i, row) in rows.iter().enumerate() {
            if row.is_none() {
                next.predict(relations, i);
            }
        }
        if limit.is_none() && (0..groups).all(|group| most(&next, group) <= least[group]) {
            break;
        }
        sent.clone_from(&total);
        total.add(&next);
        last = next;
        bounces += 1;
    }
    if limit.is_none() {
        sent.clone_from(&total);
    }
    CoarseBounces { total, sent, bounces }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_points_that_see_each_other_have_the_geometric_series() {
        let relations =
            Relations { push_offsets: vec![0, 0, 0], pull_offsets: vec![0], ..Relations::default() };
        let rho = Vec3::new(0.5, 0.25, 0.0);
        let rows = [Some(vec![(1, rho)]), Some(vec![(0, rho)])];
        let first = GroupField { groups: 1, values: vec![Vec3::ONE; 2] };
        let all = coarse_bounces(first.clone(), &rows, &relations, None);
        for value in &all.total.values {
            assert!((*value - Vec3::new(2.0, 4.0 / 3.0, 1.0)).length() < 1e-3, "{value}");
        }
        let three = coarse_bounces(first, &rows, &relations, Some(3));
        assert_eq!(three.total.values[0], Vec3::ONE + rho + rho * rho);
        assert_eq!((three.sent.values[0], three.bounces), (Vec3::ONE + rho, 3));
    }
}
