// Minifies shaders for the browser: removes comments and spaces, shortens names.

use std::collections::BTreeMap;

/// Built-in functions of WGSL: identifiers with these names are never renamed.
const BUILT_IN: &str = " abs acos acosh all any arrayLength asin asinh atan atan2 atanh bitcast ceil clamp cos cosh \
    countLeadingZeros countOneBits countTrailingZeros cross degrees determinant distance dot dpdx dpdxCoarse dpdxFine dpdy \
    dpdyCoarse dpdyFine exp exp2 extractBits faceForward firstLeadingBit firstTrailingBit floor fma fract frexp fwidth \
    fwidthCoarse fwidthFine insertBits inverseSqrt ldexp length log log2 max min mix modf normalize pow quantizeToF16 \
    radians reflect refract reverseBits round saturate select sign sin sinh smoothstep sqrt step storageBarrier tan tanh \
    transpose trunc workgroupBarrier workgroupUniformLoad ";
/// Keywords and reserved words as short as the generated names.
const WORDS: &str = " as do fn if in is of or ";

/// A word, a number or a punctuation character; `apart`: whitespace or a line break comes before the token.
struct Token<'a> {
    text: &'a str,
    apart: bool,
}

fn is_word(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

fn starts_name(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
}

fn tokens(source: &str) -> Vec<Token<'_>> {
    let mut tokens = Vec::new();
    for line in source.lines() {
        let mut rest = line.split("//").next().unwrap_or_default();
        let mut apart = true;
        while let Some(first) = rest.chars().next() {
            let digits = rest.trim_start_matches('.').starts_with(|c: char| c.is_ascii_digit());
            let length = if first.is_whitespace() {
                apart = true;
                rest = &rest[first.len_utf8()..];
                continue;
            } else if starts_name(rest) {
                rest.find(|c| !is_word(c)).unwrap_or(rest.len())
            } else if digits && (first == '.' || first.is_ascii_digit()) {
                number(rest)
            } else {
                first.len_utf8()
            };
            tokens.push(Token { text: &rest[..length], apart });
            rest = &rest[length..];
            apart = false;
        }
    }
    tokens
}

/// Length of the number at the start of a text.
fn number(text: &str) -> usize {
    let is_hex = text.starts_with("0x");
    let mut before = ' ';
    for (i, c) in text.char_indices() {
        let exponent = !is_hex && matches!(before, 'e' | 'E') && matches!(c, '+' | '-');
        if !(is_word(c) || c == '.' || exponent) {
            return i;
        }
        before = c;
    }
    text.len()
}

/// Marks tokens with names fixed by the language or the caller: attributes, entry points, overrides.
fn fixed(tokens: &[Token<'_>]) -> Vec<bool> {
    let mut fixed = vec![false; tokens.len()];
    let mut is_entry = false;
    for i in 0..tokens.len() {
        let before = if i > 0 { tokens[i - 1].text } else { "" };
        match tokens[i].text {
            "vertex" | "fragment" | "compute" if before == "@" => (is_entry, fixed[i]) = (true, true),
            "builtin" | "interpolate" if before == "@" => {
                let end = tokens[i..].iter().position(|t| t.text == ")").unwrap_or(0);
                fixed[i..=i + end].fill(true);
            }
            _ if before == "@" || before == "override" => fixed[i] = true,
            _ if before == "fn" => fixed[i] = std::mem::take(&mut is_entry),
            _ => {}
        }
    }
    fixed
}

/// Whether the name at `i` is declared at `i`.
fn declares(tokens: &[Token<'_>], i: usize) -> bool {
    let at = |i: usize| tokens.get(i).map_or("", |t| t.text);
    let before = if i > 0 { at(i - 1) } else { "" };
    if !starts_name(at(i)) || matches!(at(i), "case" | "default") || before == "case" {
        return false;
    }
    // `var<storage, read> name: …` is recognized by the colon.
    matches!(before, "fn" | "struct" | "let" | "var" | "const" | "override" | "alias") || at(i + 1) == ":"
}

/// Whether a name may be a swizzle, which looks like a member.
fn is_swizzle(name: &str) -> bool {
    name.len() <= 4 && ["xyzw", "rgba"].iter().any(|set| name.chars().all(|c| set.contains(c)))
}

/// All names of one or two letters.
fn short_names() -> impl Iterator<Item = String> {
    let letters = || ('a'..='z').chain('A'..='Z');
    letters().map(String::from).chain(letters().flat_map(move |a| letters().map(move |b| format!("{a}{b}"))))
}

/// Minifies shaders that may be concatenated in any combination: renaming is common to all shaders.
pub fn minified(sources: &[String]) -> Vec<String> {
    let files: Vec<_> = sources.iter().map(|source| tokens(source)).collect();
    // Number of uses of a name, whether the name is declared, and whether the name must stay.
    let mut names: BTreeMap<&str, (usize, bool, bool)> = BTreeMap::new();
    for tokens in &files {
        for (i, (token, fixed)) in tokens.iter().zip(fixed(tokens)).enumerate() {
            if starts_name(token.text) {
                let entry = names.entry(token.text).or_default();
                let entry_point = fixed && i > 0 && matches!(tokens[i - 1].text, "fn" | "override");
                *entry = (entry.0 + 1, entry.1 || declares(tokens, i), entry.2 || entry_point);
            }
        }
    }
    let is_built_in = |name: &str| BUILT_IN.contains(&format!(" {name} ")) || name.starts_with("texture");
    let renamed = |name: &str, declared: bool, stays: bool| {
        declared && !stays && !is_built_in(name) && !is_swizzle(name)
    };
    let mut long: Vec<_> = names.iter().filter(|(name, n)| renamed(name, n.1, n.2)).collect();
    long.sort_by_key(|(name, n)| (std::cmp::Reverse(n.0), **name));
    let taken = |name: &String| names.get(name.as_str()).is_some_and(|n| !renamed(name, n.1, n.2));
    let free = short_names().filter(|name| {
        !taken(name) && !is_swizzle(name) && !is_built_in(name) && !WORDS.contains(&format!(" {name} "))
    });
    let short: BTreeMap<_, _> = long.iter().map(|(name, _)| **name).zip(free).collect();
    files.iter().map(|tokens| written(tokens, &short)).collect()
}

fn written(tokens: &[Token<'_>], short: &BTreeMap<&str, String>) -> String {
    let mut out = String::new();
    for (token, fixed) in tokens.iter().zip(fixed(tokens)) {
        let text = short.get(token.text).filter(|_| !fixed).map_or(token.text, String::as_str);
        let (before, next) = (out.chars().last().unwrap_or(' '), text.chars().next().unwrap_or(' '));
        // Adjacent operators might form a different operator.
        let is_sign = |c: char| "+-*/%&|^<>=!".contains(c);
        if is_word(before) && is_word(next) || token.apart && is_sign(before) && is_sign(next) {
            out.push(' ');
        }
        out.push_str(text);
    }
    out + "\n"
}
