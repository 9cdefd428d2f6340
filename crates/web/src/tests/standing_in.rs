//! Is there a sharp picture before a side table is there, and does the log still replay?

use super::*;
use foveal_core::content::demand::Content;
use foveal_core::content::policy::Policy;
use foveal_core::content::video::bytes::signatures::{SIGNATURES, SIGNATURES_VERSION};
use foveal_core::perception::measures::contrast::{BandContrast, Signature};
use foveal_core::session::log_of_parts::SessionLog;
use foveal_core::session::unit_states::Piece;
use std::sync::Arc;

const DEMO: &str = r#","paused":true,"log":true"#;

/// Rows of texture that is alike everywhere.
fn signatures(units: usize) -> Vec<u8> {
    let band = |before: f64, after: f64| BandContrast {
        before,
        after,
        difference: after - before,
        norm: after - before,
    };
    let signature = Signature {
        bands: [band(0.0, 0.2), band(0.1, 0.2), band(0.2, 0.2)],
    };
    signature.to_bytes().repeat(units)
}

fn host() -> Host {
    Host::with(|units| {
        vec![SideTable {
            name: SIGNATURES.to_owned(),
            version: SIGNATURES_VERSION,
            bytes: signatures(units),
        }]
    })
}

/// The need of the table that was asked for.
fn table(player: &mut PagePlayer) -> Need {
    let is_table = |need: &&Need| matches!(need.part, Part::Table(_));
    let mut tables = player.needs().iter().filter(is_table);
    let table = tables.next().unwrap().clone();
    assert_eq!(table.part, Part::Table(SIGNATURES.to_owned()));
    assert!(table.early && tables.next().is_none());
    table
}

fn bring_table(host: &Host, player: &mut PagePlayer) {
    assert!(player.awaits_tables());
    let table = table(player);
    let arrival = player.arrived(table.offset, stretch(&host.file, &table));
    assert_eq!(arrival, Ok(Arrival::Taken));
    assert!(!player.awaits_tables());
}

fn demo(host: &Host, policy: &str, more: &str) -> PagePlayer {
    host.player_by(policy, &format!("{DEMO}{more}"))
}

/// Steps and answers for a while; when that ended.
fn look(host: &Host, player: &mut PagePlayer, from: f64) -> f64 {
    let steps = 40;
    for step in 0..steps {
        player.step(Seconds(from + 0.05 * f64::from(step))).unwrap();
        host.answer(player);
    }
    from + 0.05 * f64::from(steps)
}

fn stats(player: &PagePlayer) -> serde_json::Value {
    serde_json::from_str(&player.stats(Seconds(9.0))).unwrap()
}

/// The policies of a log's parts, which must replay.
fn logged(player: &PagePlayer) -> Vec<Policy> {
    let text = player.log();
    let log = SessionLog::parse(text).unwrap();
    let video = video(player);
    let again = log.replay(&|_, head, config| Arc::clone(video).demand(head, config));
    assert_eq!(again.write(), text);
    log.parts
        .iter()
        .map(|part| part.head.policy.policy)
        .collect()
}

#[test]
fn acuity_stands_in_until_the_signatures_are_there_and_the_log_replays() {
    let host = host();
    let mut player = demo(&host, "perceptual", "");
    let now = look(&host, &mut player, 0.0);
    assert!(
        player.play.session().figures().histogram[..2]
            .iter()
            .sum::<u32>()
            > 0
    );
    let before = stats(&player);
    assert_eq!(before["policy"], "perceptual");
    assert_eq!(before["target"], 9.5);
    assert!(before["expectedScore"].is_null());
    assert!(!player.is_settled(), "the table is awaited");
    assert_eq!(logged(&player), [Policy::Acuity]);

    bring_table(&host, &mut player);
    // What was shown is paid: there is no step back to the coarsest level.
    player.step(Seconds(now)).unwrap();
    let pack = video(&player).pack();
    let wanted = player.play.session().wanted().unwrap().1;
    let level = |piece: &Piece| pack.tile_of(piece.unit.unit).level;
    assert!(wanted.iter().any(|piece| level(piece) < 2));
    settle(&host, &mut player, now + 0.1);
    assert_eq!(logged(&player), [Policy::Acuity, Policy::Perceptual]);
    let expected = stats(&player)["expectedScore"].as_f64().unwrap();
    assert!(expected >= 9.5, "{expected}");
}

#[test]
fn acuity_keeps_a_score_with_signatures_and_without() {
    let host = host();
    let mut player = demo(&host, "acuity", r#","target":9"#);
    let now = look(&host, &mut player, 0.0);
    bring_table(&host, &mut player);
    settle(&host, &mut player, now);
    let told = stats(&player);
    assert_eq!(told["target"], 9.0);
    assert!(told["expectedScore"].as_f64().unwrap() >= 9.0, "{told}");
    assert_eq!(logged(&player), [Policy::Acuity; 2]);

    let bare = Host::new();
    let mut player = demo(&bare, "acuity", "");
    settle(&bare, &mut player, 0.0);
    assert!(stats(&player)["expectedScore"].is_null());
    assert_eq!(logged(&player), [Policy::Acuity]);
}

#[test]
fn a_damaged_table_leaves_what_stands_in_and_it_settles() {
    let host = host();
    let mut player = demo(&host, "perceptual", "");
    look(&host, &mut player, 0.0);
    let table = table(&mut player);
    let damaged = vec![0; table.bytes as usize];
    let again = player.arrived(table.offset, &damaged);
    assert_eq!(again, Ok(Arrival::Again));
    let told = player.arrived(table.offset, &damaged).unwrap_err();
    assert!(told.contains("side table signatures"), "{told}");
    assert!(!player.awaits_tables() && !player.needs().contains(&table));
    settle(&host, &mut player, 9.0);
    assert!(
        player.play.session().figures().histogram[..2]
            .iter()
            .sum::<u32>()
            > 0
    );
}

#[test]
fn tables_come_before_what_is_fetched_ahead_and_only_where_a_policy_chooses_by_them() {
    let host = host();
    let mut player = host.player_by("acuity", "");
    look(&host, &mut player, 0.0);
    player.viewer.begin(Seconds(2.0));
    player.step(Seconds(2.0)).unwrap();
    let table = table(&mut player);
    let needs = player.needs();
    let at = needs.iter().position(|need| *need == table).unwrap();
    let (before, after) = (&needs[..at], &needs[at + 1..]);
    assert!(before.iter().all(|need| !need.early));
    assert!(!after.is_empty() && after.iter().all(|need| need.ahead.is_some()));
    for (policy, more) in [("viewport", ""), ("coarsest", r#","poster":true"#)] {
        let mut player = host.player_by(policy, more);
        look(&host, &mut player, 0.0);
        assert!(!player.awaits_tables());
        let mut needs = player.needs().iter();
        assert!(needs.all(|need| !matches!(need.part, Part::Table(_))));
    }
}

#[test]
fn a_slope_has_no_target_and_a_key_asks_for_a_score_in_its_place() {
    let host = Host::new();
    let mut player = demo(&host, "acuity", r#","slope":0.011"#);
    settle(&host, &mut player, 0.0);
    assert!(stats(&player)["target"].is_null());
    player.next_target(-1).unwrap();
    assert_eq!(stats(&player)["target"], 9.75);
    settle(&host, &mut player, 1.0);
    player.set_policy(Policy::Viewport).unwrap();
    assert_eq!(player.next_target(1), None);
}
