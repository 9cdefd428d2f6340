//! What is the value of a real number of 16 bits?

/// The value of a real number of 16 bits: IEEE 754-2008, binary16.
pub(super) fn half(bits: u16) -> f64 {
    let fraction = f64::from(bits & 0x3ff) / 1024.0;
    let value = match bits >> 10 & 31 {
        0 => fraction * (-14.0_f64).exp2(),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        power => (1.0 + fraction) * (f64::from(power) - 15.0).exp2(),
    };
    if bits >> 15 == 1 { -value } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_read_as_the_standard_says() {
        let all = [
            (0x3c00, 1.0),
            (0xc000, -2.0),
            (0x7bff, 65_504.0),
            (1, 5.960_464_477_539_063e-8),
        ];
        for (bits, value) in all {
            assert_eq!(half(bits), value);
        }
        assert!(half(0x7e00).is_nan() && half(0xfc00) == f64::NEG_INFINITY);
    }
}
