//! Which number does a key name in what a command printed?

use serde_json::Value;

/// The number that `key` leads to: names and places joined by dots, as `rows.0.jod`. A place may be
/// conditions instead, as `rows.[policy=acuity & target=9.5].jod`: the first row that meets them.
pub(super) fn number(value: &Value, key: &str) -> Result<f64, String> {
    let mut at = value;
    for step in steps(key) {
        at = next(at, step).ok_or_else(|| format!("{key}: there is no {step}"))?;
    }
    match at {
        Value::Bool(flag) => Ok(f64::from(u8::from(*flag))),
        _ => at
            .as_f64()
            .ok_or_else(|| format!("{key}: {at} is no number")),
    }
}

/// Splits at dots outside brackets.
fn steps(key: &str) -> Vec<&str> {
    let mut inside = false;
    let at_dot = |c: char| {
        inside = (inside || c == '[') && c != ']';
        c == '.' && !inside
    };
    key.split(at_dot).collect()
}

fn next<'a>(value: &'a Value, step: &str) -> Option<&'a Value> {
    if let Some(conditions) = step.strip_prefix('[').and_then(|s| s.strip_suffix(']')) {
        let meets = |row: &&Value| conditions.split(" & ").all(|one| is_met(row, one));
        return value.as_array()?.iter().find(meets);
    }
    match value {
        Value::Array(rows) => rows.get(step.parse::<usize>().ok()?),
        _ => value.get(step),
    }
}

fn is_met(row: &Value, condition: &str) -> bool {
    let Some((name, wanted)) = condition.split_once('=') else {
        return false;
    };
    match row.get(name) {
        Some(Value::String(text)) => text == wanted,
        Some(Value::Number(number)) => number.as_f64() == wanted.parse().ok(),
        Some(Value::Null) | None => wanted == "null",
        Some(Value::Bool(flag)) => wanted.parse() == Ok(*flag),
        Some(_) => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_key_goes_through_names_places_and_conditions() {
        let value = json!({"rows": [
            {"policy": "acuity", "target": 9.0, "jod": 8.9},
            {"policy": "acuity", "target": 9.5, "jod": 9.4, "sizes": [1, 2]},
        ]});
        let number = |key| number(&value, key);
        assert_eq!(number("rows.0.jod"), Ok(8.9));
        assert_eq!(number("rows.[policy=acuity & target=9.5].jod"), Ok(9.4));
        assert_eq!(number("rows.[sizes=null].jod"), Ok(8.9));
        assert_eq!(number("rows.1.sizes.1"), Ok(2.0));
        assert!(number("rows.2.jod").is_err_and(|message| message.contains("no 2")));
        assert!(number("rows").is_err());
    }
}
