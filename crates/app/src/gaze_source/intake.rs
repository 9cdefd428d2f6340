//! Which rows do a sender's messages hold, and what is skipped?

use crate::gaze_source::choice::LiveChoice;
use crate::report::output::say;
use foveal_core::gaze::read::osc::EyeMessages;
use foveal_core::gaze::read::record::{GazeRecord, MAX_RECORD_BYTES};
use foveal_core::gaze::read::row::TraceRow;
use foveal_core::gaze::read::stream::GazeStream;
use foveal_core::units::{Seconds, counted, one_line};
use rosc::{OscMessage, OscPacket, OscType};
use serde::Serialize;

/// What became of what a sender sent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub(crate) struct Counts {
    /// What is no record.
    pub(crate) skipped: u64,
    /// Records that came after newer ones.
    pub(crate) late: u64,
    /// Rows that were not fetched in time.
    pub(crate) dropped: u64,
    /// Messages of others than the sender who holds the source.
    pub(crate) foreign: u64,
    /// How often the sender's clock restarted.
    pub(crate) anew: u64,
    /// Records that were dated by their arrival, since the sender's clock leaps or stands.
    pub(crate) untimed: u64,
}

/// Makes rows of messages.
#[derive(Debug)]
pub(super) struct Intake {
    name: String,
    pub(super) stream: GazeStream,
    eyes: Option<EyeMessages>,
    skipped: u64,
}

impl Intake {
    pub(super) fn new(choice: &LiveChoice) -> Self {
        Self {
            name: choice.to_string(),
            stream: GazeStream::default(),
            eyes: matches!(choice, LiveChoice::Osc(_)).then(EyeMessages::default),
            skipped: 0,
        }
    }

    /// The rows of a message that arrived at `arrived`; what is no record is counted, and said the
    /// first time.
    pub(super) fn take(&mut self, message: &[u8], arrived: Seconds) -> Vec<TraceRow> {
        let records = match &mut self.eyes {
            Some(eyes) => vec![eye_record(eyes, message, arrived)],
            None => lines(message),
        };
        let mut rows = Vec::new();
        for record in records {
            match record {
                Ok(Some(record)) => {
                    let trusted = self.stream.untimed() == 0;
                    rows.extend(self.stream.take(&record, arrived));
                    if trusted && self.stream.untimed() > 0 {
                        self.tell_of_clock();
                    }
                }
                Ok(None) => {}
                Err(why) => self.skip(&why),
            }
        }
        rows
    }

    pub(super) fn counts(&self, dropped: u64, foreign: u64) -> Counts {
        Counts {
            skipped: self.skipped,
            late: self.stream.late(),
            dropped,
            foreign,
            anew: self.stream.anew(),
            untimed: self.stream.untimed(),
        }
    }

    fn tell_of_clock(&self) {
        say(&format!(
            "warning: {}: the sender's clock leaps or stands, so what it sends is dated by when it \
             arrives, until the clock goes as time does; is t_s in seconds?",
            self.name
        ));
    }

    fn skip(&mut self, why: &str) {
        if self.skipped == 0 {
            say(&format!(
                "warning: {}: skipped what is no gaze ({}); others like it are only counted",
                self.name,
                one_line(why)
            ));
        }
        self.skipped += 1;
    }
}

type Read = Result<Option<GazeRecord>, String>;

/// A record a line; empty lines are nothing.
fn lines(message: &[u8]) -> Vec<Read> {
    let lines = message.split(|byte| *byte == b'\n');
    let lines = lines.filter(|line| !line.trim_ascii().is_empty());
    let read = |line| GazeRecord::parse(line).map(Some);
    lines
        .map(|line| read(line).map_err(|error| error.to_string()))
        .collect()
}

/// The last record of a packet: both axes of a gaze may come as messages of their own.
fn eye_record(eyes: &mut EyeMessages, packet: &[u8], arrived: Seconds) -> Read {
    // Packets may nest; the limit also bounds how deep.
    if packet.len() > MAX_RECORD_BYTES {
        return Err(format!(
            "an OSC packet of {}",
            counted(packet.len(), "byte")
        ));
    }
    let (_, packet) = rosc::decoder::decode_udp(packet).map_err(|error| error.to_string())?;
    let mut messages = Vec::new();
    flatten(packet, &mut messages);
    let mut newest = None;
    for OscMessage { addr, args } in messages {
        let values: Vec<f64> = args.iter().map(number).collect();
        let record = eyes.take(&addr, &values, arrived);
        newest = record.map_err(|error| error.to_string())?.or(newest);
    }
    Ok(newest)
}

fn flatten(packet: OscPacket, messages: &mut Vec<OscMessage>) {
    match packet {
        OscPacket::Message(message) => messages.push(message),
        OscPacket::Bundle(bundle) => {
            for packet in bundle.content {
                flatten(packet, messages);
            }
        }
    }
}

/// An argument as a number; anything else becomes no direction.
fn number(argument: &OscType) -> f64 {
    match argument {
        OscType::Float(value) => f64::from(*value),
        OscType::Double(value) => *value,
        OscType::Int(value) => f64::from(*value),
        _ => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn intake(choice: fn(String) -> LiveChoice) -> Intake {
        Intake::new(&choice("127.0.0.1:0".to_owned()))
    }

    fn packet(address: &str, values: &[f32]) -> OscPacket {
        OscPacket::Message(OscMessage {
            addr: address.to_owned(),
            args: values.iter().map(|value| OscType::Float(*value)).collect(),
        })
    }

    #[test]
    fn one_message_may_hold_many_lines_and_bad_ones_do_not_spoil_the_others() {
        let mut intake = intake(LiveChoice::Udp);
        let text = "{\"t_s\":0,\"yaw_deg\":1,\"pitch_deg\":2}\r\n\nrubbish\n\
                    {\"t_s\":0.1,\"yaw_deg\":2,\"pitch_deg\":2}\n\
                    {\"t_s\":0.05,\"yaw_deg\":3,\"pitch_deg\":2}\n";
        let rows = intake.take(text.as_bytes(), Seconds(9.0));
        let yaws: Vec<f64> = rows.iter().map(|row| row.gaze_deg.unwrap()[0]).collect();
        assert_eq!(yaws, [1.0, 2.0]);
        let counts = Counts {
            skipped: 1,
            late: 1,
            dropped: 4,
            foreign: 5,
            anew: 0,
            untimed: 0,
        };
        assert_eq!(intake.counts(4, 5), counts);
    }

    #[test]
    fn a_bundle_of_eye_messages_is_one_row() {
        let mut intake = intake(LiveChoice::Osc);
        let bundle = OscPacket::Bundle(rosc::OscBundle {
            timetag: (0, 1).into(),
            content: vec![
                packet("/avatar/parameters/v2/EyeX", &[0.5]),
                packet("/avatar/parameters/v2/JawOpen", &[0.5]),
                packet("/avatar/parameters/v2/EyeY", &[0.2]),
            ],
        });
        let bytes = rosc::encoder::encode(&bundle).unwrap();
        let rows = intake.take(&bytes, Seconds(1.0));
        assert_eq!(rows.len(), 1);
        let [yaw, pitch] = rows[0].gaze_deg.unwrap();
        assert!((yaw - 22.5).abs() < 1e-5 && (pitch - 9.0).abs() < 1e-5);
    }

    #[test]
    fn a_generated_corpus_of_damaged_packets_never_panics() {
        let message = |n: i32| packet("/tracking/eye/LeftRightPitchYaw", &[n as f32; 4]);
        let inner = OscPacket::Bundle(rosc::OscBundle {
            timetag: (0, 1).into(),
            content: vec![message(1), message(2)],
        });
        let outer = OscPacket::Bundle(rosc::OscBundle {
            timetag: (0, 1).into(),
            content: vec![inner, message(3), packet("/x", &[])],
        });
        let good = rosc::encoder::encode(&outer).unwrap();
        let mut random = foveal_core::view::random::Random::new(2);
        let (mut intake, mut rows) = (intake(LiveChoice::Osc), 0);
        for n in 0..20_000 {
            let mut bad = good.clone();
            for _ in 0..3 {
                let place = (random.unit() * bad.len() as f64) as usize;
                bad[place] = (random.unit() * 256.0) as u8;
            }
            bad.truncate((random.unit() * 2.0 * bad.len() as f64) as usize);
            rows += intake.take(&bad, Seconds(f64::from(n) * 0.01)).len();
        }
        let skipped = intake.counts(0, 0).skipped;
        assert!(
            rows > 100 && skipped > 1000,
            "{rows} rows, {skipped} skipped"
        );
    }

    #[test]
    fn packets_that_are_no_osc_are_counted_whatever_they_nest() {
        let mut intake = intake(LiveChoice::Osc);
        let mut nested = Vec::new();
        for _ in 0..200 {
            let mut outer = b"#bundle\0\0\0\0\0\0\0\0\x01".to_vec();
            outer.extend((nested.len() as u32).to_be_bytes());
            outer.extend(&nested);
            nested = outer;
        }
        let tags = format!("/a\0\0,{}\0\0\0", "[".repeat(4000));
        let bad = packet("/tracking/eye/CenterPitchYaw", &[f32::NAN, 0.0]);
        let bad = rosc::encoder::encode(&bad).unwrap();
        let long = vec![b'/'; 60_000];
        for bytes in [&nested[..], tags.as_bytes(), b"hello", b"", &long, &bad] {
            assert!(intake.take(bytes, Seconds(1.0)).is_empty());
        }
        assert!(intake.counts(0, 0).skipped >= 4);
    }
}
