// Minifies shaders for the browser: removes comments and spaces, shortens names.

use std::collections::BTreeMap;
use std::ops::Range;

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

/// Single letters, for names within functions.
const LETTERS: &str = "abcdefghijklmnopqrstuvwxyz";

/// Names of one or two letters for what functions share: not those of names within functions.
fn shared_names() -> impl Iterator<Item = String> {
    let letters = || ('a'..='z').chain('A'..='Z');
    ('A'..='Z')
        .map(String::from)
        .chain(letters().flat_map(move |a| letters().map(move |b| format!("{a}{b}"))))
}

/// The functions of a source: from the opening parenthesis of the parameters to the closing brace.
fn functions(tokens: &[Token<'_>]) -> Vec<Range<usize>> {
    let mut out = Vec::new();
    for start in (0..tokens.len()).filter(|i| tokens[*i].text == "fn") {
        let mut depth = 0;
        let end = tokens[start..].iter().position(|token| {
            depth += i32::from(token.text == "{") - i32::from(token.text == "}");
            depth == 0 && token.text == "}"
        });
        out.push(start + 2..start + end.unwrap_or(0) + 1);
    }
    out
}

/// Short names of the parameters and variables of a function, in the order of their declarations.
fn local_names<'a>(function: &[Token<'a>], fixed: &[bool]) -> BTreeMap<&'a str, String> {
    let is_member = |i: usize| i > 0 && function[i - 1].text == ".";
    let is_called = |name: &str| {
        (1..function.len())
            .any(|i| function[i].text == "(" && function[i - 1].text == name && !is_member(i - 1))
    };
    let mut found: Vec<&str> = Vec::new();
    for i in 0..function.len() {
        let name = function[i].text;
        if !fixed[i] && !is_member(i) && declares(function, i) && !found.contains(&name) && !is_called(name) {
            found.push(name);
        }
    }
    // Letters that nothing else there has; for as many of the names as there are letters.
    loop {
        let is_free = |letter: &String| {
            (0..function.len())
                .all(|i| function[i].text != letter || is_member(i) || found.contains(&letter.as_str()))
        };
        let free: Vec<String> = LETTERS.chars().map(String::from).filter(is_free).collect();
        if free.len() >= found.len() {
            return found.into_iter().zip(free).collect();
        }
        found.truncate(free.len());
    }
}

/// Minifies shaders that may be concatenated in any combination: what functions share has one new name in all of them.
/// The names of the `first` sources, by how often they use them, do not depend on the others.
pub fn minified(sources: &[String], first: usize) -> Vec<String> {
    let files: Vec<Vec<Token<'_>>> = sources.iter().map(|source| tokens(source)).collect();
    let locals: Vec<Vec<Option<String>>> = files.iter().map(|tokens| renamed_locals(tokens)).collect();
    // Number of uses of a name in the first sources, whether the name is declared, and whether the name must stay.
    let mut names: BTreeMap<&str, (usize, bool, bool)> = BTreeMap::new();
    for (file, (tokens, locals)) in files.iter().zip(&locals).enumerate() {
        for (i, (token, fixed)) in tokens.iter().zip(fixed(tokens)).enumerate() {
            if starts_name(token.text) && locals[i].is_none() {
                let entry = names.entry(token.text).or_default();
                let entry_point = fixed && i > 0 && matches!(tokens[i - 1].text, "fn" | "override");
                *entry = (
                    entry.0 + usize::from(file < first),
                    entry.1 || declares(tokens, i),
                    entry.2 || entry_point,
                );
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
    let free = shared_names().filter(|name| {
        !taken(name) && !is_swizzle(name) && !is_built_in(name) && !WORDS.contains(&format!(" {name} "))
    });
    let short: BTreeMap<_, _> = long.iter().map(|(name, _)| **name).zip(free).collect();
    files.iter().zip(&locals).map(|(tokens, locals)| written(tokens, locals, &short)).collect()
}

/// The new name of each token that is a parameter or variable of a function.
fn renamed_locals(tokens: &[Token<'_>]) -> Vec<Option<String>> {
    let fixed = fixed(tokens);
    let mut out = vec![None; tokens.len()];
    for range in functions(tokens) {
        let names = local_names(&tokens[range.clone()], &fixed[range.clone()]);
        for i in range {
            if !fixed[i] && tokens[i - 1].text != "." {
                out[i] = names.get(tokens[i].text).cloned();
            }
        }
    }
    out
}

fn written(tokens: &[Token<'_>], locals: &[Option<String>], short: &BTreeMap<&str, String>) -> String {
    let mut out = String::new();
    for (i, (token, fixed)) in tokens.iter().zip(fixed(tokens)).enumerate() {
        let shared = short.get(token.text).filter(|_| !fixed);
        let text = locals[i].as_ref().or(shared).map_or(token.text, String::as_str);
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
