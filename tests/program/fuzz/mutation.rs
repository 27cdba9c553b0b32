//! Random damage to a text: bytes, lines, numbers, words.

/// Random numbers, the same on every machine: the sequence of Steele, Lea and Flood (2014), "Fast splittable pseudorandom number generators".
pub struct Random(u64);

impl Random {
    /// Those of one case of a seed.
    pub fn of(seed: u64, case: u64) -> Self {
        let mut random = Random(seed ^ case.wrapping_mul(0xd134_2543_de82_ef95));
        random.next();
        random
    }

    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// A place below `count`; 0 where there is none.
    pub fn below(&mut self, count: usize) -> usize {
        (self.next() % count.max(1) as u64) as usize
    }

    pub fn of_these<T: Copy>(&mut self, values: &[T]) -> T {
        values[self.below(values.len())]
    }
}

/// What stands in the place of a number.
const NUMBERS: [&str; 12] =
    ["0", "-1", "1e308", "-1e308", "1e-308", "5e-324", "-0.0", "0.5", "1e999", "", "abc", "1.5e3"];

/// The same, not finite.
const NOT_FINITE: [&str; 4] = ["nan", "inf", "-inf", "NaN"];

/// The same, whole and larger than memory or index types.
const HUGE: [&str; 5] =
    ["4294967296", "1000000000000", "9223372036854775807", "18446744073709551615", "99999999999999999999"];

/// Bytes that mean something to a parser.
const BYTES: &[u8] = b"\n\r\t \"'[]{}=:,.#-+\\0719eE\x00\xff";

/// The text with one to three of its parts damaged.
pub fn mutated(text: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = text.to_vec();
    for _ in 0..=random.below(3) {
        bytes = once(&bytes, random);
    }
    bytes
}

fn once(text: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = text.to_vec();
    let at = random.below(bytes.len());
    match random.below(12) {
        0 => {
            if let Some(byte) = bytes.get_mut(at) {
                *byte ^= 1 << random.below(8);
            }
        }
        1 => drop(bytes.drain(at..(at + 1 + random.below(8)).min(text.len()))),
        2 => {
            let inserted: Vec<u8> = (0..=random.below(3)).map(|_| random.of_these(BYTES)).collect();
            drop(bytes.splice(at..at, inserted));
        }
        // A file that was cut, with and without the line break that is asked for.
        3 => bytes.truncate(at),
        4 => {
            bytes.truncate(at);
            bytes.push(b'\n');
        }
        5 | 6 => bytes = lines_moved(&bytes, random),
        7..=9 => replace(&mut bytes, is_number, &number(random), random),
        10 => {
            let word = word(&bytes, random);
            replace(&mut bytes, is_word, &word, random);
        }
        _ => {
            let all = words(&bytes, is_word);
            if !all.is_empty() {
                let place = all[place(all.len(), random)].clone();
                let renamed = renamed(&bytes[place.clone()], random);
                drop(bytes.splice(place, renamed));
            }
        }
    }
    bytes
}

/// A line that stands twice, is gone, or has changed places with another.
fn lines_moved(text: &[u8], random: &mut Random) -> Vec<u8> {
    let mut lines: Vec<&[u8]> = text.split_inclusive(|&byte| byte == b'\n').collect();
    if lines.is_empty() {
        return Vec::new();
    }
    let (one, other) = (random.below(lines.len()), random.below(lines.len()));
    match random.below(3) {
        0 => lines.swap(one, other),
        1 => lines.insert(other, lines[one]),
        _ => drop(lines.remove(one)),
    }
    lines.concat()
}

fn number(random: &mut Random) -> Vec<u8> {
    let mut all = NUMBERS.to_vec();
    all.extend(NOT_FINITE);
    all.extend(HUGE);
    random.of_these(&all).into()
}

/// Puts another text in the place of a word that fits.
fn replace(bytes: &mut Vec<u8>, fits: fn(&[u8]) -> bool, with: &[u8], random: &mut Random) {
    let all = words(bytes, fits);
    if !all.is_empty() {
        let place = all[place(all.len(), random)].clone();
        drop(bytes.splice(place, with.iter().copied()));
    }
}

/// One of so many places: in every other case one of the first, where headers are, for a packing is rows of numbers.
fn place(count: usize, random: &mut Random) -> usize {
    let header = random.below(2) == 0;
    random.below(if header { count.min(30) } else { count })
}

/// A word of the text.
fn word(bytes: &[u8], random: &mut Random) -> Vec<u8> {
    let all = words(bytes, is_word);
    if all.is_empty() { Vec::new() } else { bytes[all[random.below(all.len())].clone()].to_vec() }
}

fn renamed(word: &[u8], random: &mut Random) -> Vec<u8> {
    match random.below(3) {
        0 => word.to_ascii_uppercase(),
        1 => [word, b"s"].concat(),
        _ => word.iter().skip(1).copied().collect(),
    }
}

/// Where the words are that fit.
fn words(bytes: &[u8], fits: fn(&[u8]) -> bool) -> Vec<std::ops::Range<usize>> {
    let within = |byte: u8| byte.is_ascii_alphanumeric() || b"_.+-".contains(&byte);
    let mut found = Vec::new();
    let mut start = 0;
    for end in 0..=bytes.len() {
        if bytes.get(end).is_none_or(|&byte| !within(byte)) {
            if fits(&bytes[start..end]) {
                found.push(start..end);
            }
            start = end + 1;
        }
    }
    found
}

fn is_number(word: &[u8]) -> bool {
    let starts = word.first().is_some_and(|&byte| byte.is_ascii_digit() || b"+-.".contains(&byte));
    starts && std::str::from_utf8(word).is_ok_and(|word| word.parse::<f64>().is_ok())
}

fn is_word(word: &[u8]) -> bool {
    word.first().is_some_and(u8::is_ascii_alphabetic)
}

#[test]
fn a_case_is_the_same_each_time_and_differs_from_the_next() {
    let text = b"[sample]\nseed = 3\nsource = { pressure = 10.0 }\n";
    let case = |seed, case| mutated(text, &mut Random::of(seed, case));
    assert_eq!(case(1, 7), case(1, 7));
    let all: std::collections::BTreeSet<Vec<u8>> = (0..100).map(|index| case(1, index)).collect();
    assert!(all.len() > 80 && all.iter().all(|text| std::str::from_utf8(text).is_err() || text.len() < 200));
    assert_eq!(words(b"a=1.5 -2 b", is_number).len(), 2);
    assert_eq!(words(b"a=1.5 -2 b", is_word), [0..1, 9..10]);
}
