//! What do lines of numbers say in an OBJ file, and lines that name what is not read?

use glam::DVec3;

use super::super::error::Fault;
use super::super::mends;
use super::super::sound::count;
use super::super::text::{LineNumbers, Words, shortened};
use super::{Reader, UNSAID};

impl Reader<'_> {
    /// Reads a line of numbers. What is no number is NaN, so that later lines keep their numbers.
    pub(super) fn read_numbers(
        &mut self,
        keyword: &str,
        words: &mut Words<'_>,
    ) -> Result<(), Fault> {
        if !keyword.starts_with('v') {
            words.leave_out_comment();
        }
        match keyword {
            "v" => self.read_place(words),
            "vn" => {
                let row = words.row(|count| count == 3);
                self.normals.push([0, 1, 2].map(|at| row.at(at) as f32));
            }
            "vt" => self.read_uv(words),
            "p" => self.points.read(words, self.places.len()),
            "l" => {
                let lines = self.points.read_line(words, self.places.len());
                count(&mut self.scene.repairs, "lines_left_out", lines);
            }
            _ => self.read_face(words)?,
        }
        if words.commas + words.glued > 0 || words.is_broken {
            let line = words.line;
            let place = || format!("in line {line}");
            self.mends.add(mends::COMMA, words.commas, place);
            self.mends.add(mends::GLUED, words.glued, place);
            let broken = usize::from(words.is_broken);
            self.mends.add(mends::LINE_BROKEN, broken, place);
        }
        Ok(())
    }

    fn read_uv(&mut self, words: &mut Words<'_>) {
        let usual = self.uv_columns;
        let row = words.row(|count| match usual {
            0 => matches!(count, 2 | 3),
            usual => count == usual,
        });
        if !words.is_broken {
            self.uv_columns = row.count;
        }
        let (u, v) = (row.at(0), row.get(1).unwrap_or(0.0));
        // Here 0 is at the bottom of pictures.
        let place = [u, 1.0 - v].map(|along| match along.is_finite() {
            true => along.clamp(-1e6, 1e6) as f32,
            false => f32::NAN,
        });
        self.uvs.push(place);
    }

    /// x, y and z, maybe followed by a weight, which has no meaning here, or by a colour.
    fn read_place(&mut self, words: &mut Words<'_>) {
        let usual = self.place_columns;
        let row = words.row(|count| match usual {
            0 => matches!(count, 3 | 6),
            usual => count == usual,
        });
        if !words.is_broken {
            self.place_columns = row.count;
        }
        let mut place = [0, 1, 2].map(|at| row.at(at));
        // Drawings have two coordinates.
        if row.count < 3 {
            place[2] = 0.0;
            let line = words.line;
            self.mends.add(mends::FLAT, 1, || format!("in line {line}"));
        }
        let colour = self.colour_of(&row);
        if colour.is_some() || !self.place_colours.is_empty() {
            self.place_colours.resize(self.places.len(), UNSAID);
            self.place_colours.push(colour.unwrap_or(UNSAID));
        }
        self.places.push(DVec3::from_array(place));
    }

    /// The colour behind x, y and z, maybe with an alpha.
    fn colour_of(&mut self, row: &LineNumbers) -> Option<[f32; 4]> {
        if !matches!(row.count, 6 | 7) {
            return None;
        }
        let parts = [3, 4, 5].map(|at| row.at(at));
        self.colour_depth.add(parts);
        let [red, green, blue] = parts.map(|it| it as f32);
        Some([red, green, blue, 1.0])
    }

    /// Reports a file or picture that a line names in a way that is not followed.
    pub(super) fn leave_out_named(&mut self, keyword: &str, words: &Words<'_>) {
        let name = words.rest();
        let name = shortened(&name);
        let line = words.line;
        if keyword == "call" {
            count(&mut self.scene.repairs, "files_left_out", 1);
            self.scene.remark(format!(
                "line {line} asks for the file \"{name}\" to be read there (`call`): it is left \
                 out; put its lines in the place of this one"
            ));
        } else if !matches!(name.as_str(), "" | "off" | "none") {
            count(&mut self.scene.repairs, "missing_images", 1);
            self.scene.remark(format!(
                "line {line} puts the picture map \"{name}\" on faces (`usemap`), which is not \
                 drawn; name its picture by `map_Kd` of a material"
            ));
        }
    }
}
