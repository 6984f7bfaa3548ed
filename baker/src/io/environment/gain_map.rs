//! Metadata of a gain map: the `hdrgm` properties of its XMP (Adobe's *Gain Map Specification* 1.0, as in Google's
//! *Ultra HDR Image Format* 1.1).

use glam::Vec3;
use rebounce_shared::elementary::{Elementary, ElementaryVector};

/// Prefix of the properties.
const PREFIX: &str = "hdrgm:";
/// Largest gain or offset; twice as many stops as a 16-bit float spans.
const LARGEST: f32 = 64.0;

/// How a gain map changes a picture.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct GainMap {
    /// Base-2 logarithms of the gain at 0 and at 1, RGB.
    pub(super) least: Vec3,
    /// See `least`.
    pub(super) most: Vec3,
    /// Exponent that the map was encoded with.
    pub(super) gamma: Vec3,
    /// Added to the linear base picture before the gain, and taken away after it.
    pub(super) offset_base: Vec3,
    /// See `offset_base`.
    pub(super) offset_hdr: Vec3,
}

/// Whether an XMP text has properties of a gain map.
pub(super) fn has_gain_map(xmp: &str) -> bool {
    xmp.contains("hdrgm:GainMapMax")
}

impl GainMap {
    /// Reads the properties of an XMP text. The error says what is wrong with them.
    pub(super) fn parse(xmp: &str) -> Result<Self, String> {
        if property(xmp, "BaseRenditionIsHDR").is_some_and(|value| value.trim().eq_ignore_ascii_case("true"))
        {
            return Err("whose base picture is the HDR one, which is not read".to_owned());
        }
        let value = |name: &str, absent: f32| match property(xmp, name) {
            None => Ok(Vec3::splat(absent)),
            Some(text) => {
                numbers(text).ok_or_else(|| format!("whose {PREFIX}{name} is not a number or three"))
            }
        };
        let map = Self {
            least: value("GainMapMin", 0.0)?,
            most: value("GainMapMax", f32::NAN)?,
            gamma: value("Gamma", 1.0)?,
            offset_base: value("OffsetSDR", 1.0 / 64.0)?,
            offset_hdr: value("OffsetHDR", 1.0 / 64.0)?,
        };
        let all = [map.least, map.most, map.gamma, map.offset_base, map.offset_hdr];
        let is_usable = all.iter().all(|v| v.is_finite() && v.abs().max_element() <= LARGEST)
            && map.gamma.min_element() > 0.0
            && map.least.cmple(map.most).all();
        is_usable.then_some(map).ok_or_else(|| "whose gain map has no usable range or gamma".to_owned())
    }

    /// Radiance of a pixel of the linear base picture with a value of the map from 0 to 1, at full strength.
    pub(super) fn apply(&self, base: Vec3, map: Vec3) -> Vec3 {
        let share = Vec3::from_array(std::array::from_fn(|i| map[i].power(1.0 / self.gamma[i])));
        let gain = (self.least + (self.most - self.least) * share).exponential2();
        ((base + self.offset_base) * gain - self.offset_hdr).max(Vec3::ZERO)
    }
}

/// The text of a property: an attribute, or an element with its content.
fn property<'a>(xmp: &'a str, name: &str) -> Option<&'a str> {
    let full = format!("{PREFIX}{name}");
    for (at, _) in xmp.match_indices(&full) {
        let rest = xmp[at + full.len()..].trim_start();
        if let Some(value) = rest.strip_prefix('=') {
            let value = value.trim_start();
            let quote = value.chars().next().filter(|c| matches!(c, '"' | '\''))?;
            return value[1..].split_once(quote).map(|(text, _)| text);
        }
        if xmp[..at].ends_with('<') {
            let (_, content) = rest.split_once('>')?;
            return content.split_once(&format!("</{full}")).map(|(text, _)| text);
        }
    }
    None
}

/// One number, or three: of a list of `rdf:li` elements. One stands for all channels.
fn numbers(text: &str) -> Option<Vec3> {
    let tags: Vec<&str> = text.split("<rdf:li>").skip(1).filter_map(|item| item.split('<').next()).collect();
    let texts = if tags.is_empty() { vec![text] } else { tags };
    let values: Vec<f32> = texts.iter().map(|text| text.trim().parse().ok()).collect::<Option<_>>()?;
    match values[..] {
        [all] => Some(Vec3::splat(all)),
        [r, g, b] => Some(Vec3::new(r, g, b)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn properties_are_attributes_or_elements() {
        let xmp = r#"<rdf:Description hdrgm:Version="1.0" hdrgm:GainMapMin='-1' hdrgm:Gamma = "2"
            hdrgm:GainMapMaximum="9"><hdrgm:GainMapMax><rdf:Seq><rdf:li>1</rdf:li><rdf:li> 2.5</rdf:li>
            <rdf:li>3</rdf:li></rdf:Seq></hdrgm:GainMapMax><hdrgm:OffsetSDR>0.5</hdrgm:OffsetSDR>"#;
        let map = GainMap::parse(xmp).unwrap();
        assert_eq!((map.least, map.most), (Vec3::splat(-1.0), Vec3::new(1.0, 2.5, 3.0)));
        assert_eq!((map.gamma, map.offset_base), (Vec3::splat(2.0), Vec3::splat(0.5)));
        assert_eq!(map.offset_hdr, Vec3::splat(1.0 / 64.0));
    }

    #[test]
    fn unusable_properties_are_refused() {
        let problem = |xmp: &str| GainMap::parse(xmp).unwrap_err();
        assert!(problem("").contains("no usable range"));
        assert!(problem(r#"hdrgm:GainMapMax="x""#).contains("GainMapMax is not a number"));
        assert!(problem(r#"hdrgm:GainMapMax="2" hdrgm:Gamma="0""#).contains("gamma"));
        assert!(problem(r#"hdrgm:GainMapMax="2" hdrgm:GainMapMin="3""#).contains("range"));
        assert!(problem(r#"hdrgm:GainMapMax="inf""#).contains("range"));
        assert!(problem(r#"hdrgm:GainMapMax="2" hdrgm:BaseRenditionIsHDR="True""#).contains("base picture"));
        assert!(problem("<hdrgm:GainMapMax><rdf:li>1</rdf:li><rdf:li>2</rdf:li>").contains("range"));
    }

    #[test]
    fn gains_are_powers_of_two_between_offsets() {
        let xmp = r#"hdrgm:GainMapMin="-1" hdrgm:GainMapMax="3" hdrgm:OffsetSDR="0" hdrgm:OffsetHDR="0""#;
        let map = GainMap::parse(xmp).unwrap();
        assert_eq!(map.apply(Vec3::splat(0.5), Vec3::new(0.0, 0.25, 1.0)), Vec3::new(0.25, 0.5, 4.0));
        let offsets = GainMap::parse(r#"hdrgm:GainMapMax="3""#).unwrap();
        assert_eq!(offsets.apply(Vec3::ZERO, Vec3::ZERO), Vec3::ZERO);
    }
}
