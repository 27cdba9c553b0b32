//! Numbers for readers: significant digits, values with errors. The data files contain numbers for programs.

/// Powers of ten that are written out; others are written as ·10ⁿ.
const PLAIN_EXPONENTS: std::ops::Range<i32> = -3..6;

/// A number with this many significant digits; written with ·10ⁿ below 10⁻³ and from 10⁶ on.
pub(crate) fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return format!("{value}").replace('-', "−");
    }
    if value == 0.0 {
        return "0".into();
    }
    let decimals = digits.max(1) - 1;
    let scientific = format!("{value:.decimals$e}");
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let text = if PLAIN_EXPONENTS.contains(&exponent) {
        format!("{value:.*}", (decimals as i32 - exponent).max(0) as usize)
    } else {
        format!("{mantissa}·10{}", superscript(exponent))
    };
    text.replace('-', "−")
}

/// A value and its standard error, both to the second significant digit of the error.
#[cfg_attr(not(feature = "fit"), allow(dead_code, reason = "only fits have errors"))]
pub(crate) fn with_error(value: f64, error: f64) -> String {
    let place = libm::log10(error.abs()).floor();
    if !(value.is_finite() && (-6.0..4.0).contains(&place)) {
        return format!("{} ± {}", significant(value, 4), significant(error, 2));
    }
    let decimals = (1.0 - place).max(0.0) as usize;
    format!("{value:.decimals$} ± {error:.decimals$}").replace('-', "−")
}

/// An integer as a superscript.
pub(crate) fn superscript(integer: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raised = |digit: char| digit.to_digit(10).map_or('⁻', |digit| DIGITS[digit as usize]);
    integer.to_string().chars().map(raised).collect()
}

/// An integer with thin spaces between thousands, from five digits on.
pub(crate) fn count(integer: usize) -> String {
    let digits = integer.to_string();
    if digits.len() < 5 {
        return digits;
    }
    let gap = |index: usize| index > 0 && (digits.len() - index).is_multiple_of(3);
    digits.chars().enumerate().flat_map(|(i, digit)| gap(i).then_some(' ').into_iter().chain([digit])).collect()
}

/// Unit of a pressure.
pub(crate) fn pressure_unit(dimension: usize) -> &'static str {
    if dimension == 3 { "force/length^2" } else { "force/length" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_significant_ones() {
        assert_eq!(significant(0.052_349, 3), "0.0523");
        assert_eq!(significant(9.996e-9, 2), "1.0·10⁻⁸");
        assert_eq!(significant(-4000.04, 5), "−4000.0");
        assert_eq!(significant(3.2e12, 2), "3.2·10¹²");
        assert_eq!(significant(0.0, 3), "0");
        assert_eq!(significant(f64::NAN, 3), "NaN");
    }

    #[test]
    fn an_error_rules_the_digits_of_its_value() {
        assert_eq!(with_error(-0.051_234, 0.000_412), "−0.05123 ± 0.00041");
        assert_eq!(with_error(123.4, 12.0), "123 ± 12");
        assert_eq!(with_error(0.05, 0.0), "0.05000 ± 0");
    }

    #[test]
    fn thousands_stand_apart() {
        assert_eq!(count(5548), "5548");
        assert_eq!(count(1_234_567), "1 234 567");
    }
}
