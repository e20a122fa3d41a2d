//! From a scene file to a [`Scene`].

use super::camera::CAMERA;
use super::classified::{CLASSIFIED, VolumeTable};
use super::curve::CURVE;
use super::files::{Files, InputFile};
use super::format::{Key, Kind, Rule, Table};
use super::key_lines::{KeyLines, Lines};
use super::modulation::Modulation;
use super::objects::{Volume, check_count};
use super::radiative::RADIATIVE;
use super::reader::{Document, Origin, Reader, Reading, overridden};
use super::record::Record;
use super::sampling::SamplingTable;
use super::transfer_function::{
    OpacityByValue, TRANSFER_FUNCTION, read_range, read_transfer_function,
};
use super::{Classified, Curve, Radiative, SceneResult, TransportFault};
use crate::files::regular_file;
use crate::geometry::Camera;
use crate::math::powu;
use crate::optics::Field;
use crate::volume::{Grid, volume_format};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The declaration of a scene file.
pub const SCENE: Table = Table::new("A scene of volref: one model, the camera and the image.").keys(&[
    Key::optional("title", Kind::Text)
        .doc("Description of the image."),
    Key::optional("film", Kind::Table(&Film::TABLE))
        .doc("The image."),
    Key::optional("camera", Kind::Table(&CAMERA))
        .doc("The eye."),
    Key::optional("sampling", Kind::Table(&SamplingTable::TABLE))
        .doc("Random numbers; for radiative scenes only."),
    Key::optional("transfer_function", Kind::Table(&TRANSFER_FUNCTION))
        .doc("Colour and opacity by density; not for radiative scenes."),
    Key::optional("classified", Kind::Table(&CLASSIFIED))
        .doc("Model: a classified volume."),
    Key::optional("radiative", Kind::Table(&RADIATIVE))
        .doc("Model: surfaces, participating media and lights."),
    Key::optional("curve", Kind::Table(&CURVE))
        .doc("Model: a plot of the transfer function."),
    Key::optional("panel", Kind::Overrides(MOST_PANELS))
        .doc("Several images side by side, at most 256: each panel is the scene with the keys of the panel replaced."),
]).rules(&[Rule::ExactlyOne("model", &["classified", "radiative", "curve"])]);

record! {
    struct Film in "The image; with panels, each of them." {
        width: u32 = or("256") Count(1, 16384), "Columns of pixels.";
        height: u32 = or("256") Count(1, 16384), "Rows of pixels.";
    }
}

/// Largest image rendered, all panels together: 16384², which is also the largest image read.
const MOST_PIXELS: usize = 1 << 28;

/// Panels at most.
const MOST_PANELS: usize = 256;

/// Bytes of all panels together, at most, the whole file counted for each.
const MOST_BYTES_OF_PANELS: usize = 1 << 26;

/// Longest scene file read: 16 MiB, some hundred thousand bodies.
const MOST_BYTES: u64 = 1 << 24;

/// A scene: one image, or several side by side.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The images from left to right, at least one, all of the same height.
    pub panels: Vec<Panel>,
}

/// One image of a scene.
#[derive(Clone, Debug)]
pub struct Panel {
    /// Description.
    pub title: Option<String>,
    /// Columns of pixels.
    pub width: usize,
    /// Rows of pixels.
    pub height: usize,
    /// The model rendered.
    pub model: Model,
    /// A mistake in its transport of light: no file states one.
    pub fault: Option<TransportFault>,
    /// Its input files, in the order in which they are first named.
    pub inputs: Vec<InputFile>,
    /// Every key as read, defaults included, in a fixed order.
    pub readings: Vec<Reading>,
    /// Lines of the keys in the file.
    pub key_lines: KeyLines,
}

/// The model of a panel.
#[derive(Clone, Debug)]
pub enum Model {
    /// Direct volume rendering of a scalar grid.
    Classified(Box<Classified>),
    /// Surfaces, participating media and lights.
    Radiative(Box<Radiative>),
    /// A plot of the transfer function.
    Curve(Curve),
}

impl Model {
    /// The camera, if it has one.
    pub fn camera(&self) -> Option<&Camera> {
        match self {
            Model::Classified(scene) => Some(&scene.camera),
            Model::Radiative(scene) => Some(&scene.camera),
            Model::Curve(_) => None,
        }
    }

    /// The grids of its volumes, or of the densities of its media; one that several share occurs several times.
    pub(crate) fn grids(&self) -> Vec<&Arc<Grid<f32>>> {
        match self {
            Model::Classified(scene) => {
                let others = scene.objects.volumes.iter();
                let others = others.map(|volume| &volume.grid);
                std::iter::once(&scene.grid).chain(others).collect()
            }
            Model::Radiative(scene) => {
                let densities = scene.media.iter().filter_map(|body| body.density.as_ref());
                let grids = densities.filter_map(|density| match density.field() {
                    Field::Grid(grid) => Some(grid.grid()),
                    _ => None,
                });
                grids.collect()
            }
            Model::Curve(_) => vec![],
        }
    }
}

impl From<Classified> for Model {
    fn from(classified: Classified) -> Model {
        Model::Classified(Box::new(classified))
    }
}

impl From<Radiative> for Model {
    fn from(radiative: Radiative) -> Model {
        Model::Radiative(Box::new(radiative))
    }
}

impl Panel {
    /// Its classified volume, if it has one.
    pub fn classified(&self) -> Option<&Classified> {
        match &self.model {
            Model::Classified(classified) => Some(classified),
            Model::Radiative(_) | Model::Curve(_) => None,
        }
    }

    /// Edits the camera, with the height of a pixel over that of the image; false if there is none.
    pub(crate) fn edit_view(&mut self, edit: impl Fn(&Camera, f64) -> Camera) -> bool {
        let pixel = 1.0 / self.height as f64;
        let camera = match &mut self.model {
            Model::Classified(scene) => &mut scene.camera,
            Model::Radiative(scene) => &mut scene.camera,
            Model::Curve(_) => return false,
        };
        *camera = edit(camera, pixel);
        true
    }
}

impl Scene {
    /// A scene of one image without a file.
    pub fn of(panel: Panel) -> Scene {
        Scene {
            panels: vec![panel],
        }
    }

    /// This scene with its classified volumes changed by `edit`.
    pub fn with_volumes(&self, mut edit: impl FnMut(&mut Classified)) -> Scene {
        let mut scene = self.clone();
        for panel in &mut scene.panels {
            if let Model::Classified(volume) = &mut panel.model {
                edit(volume);
            }
        }
        scene
    }

    /// This scene with the steps of its classified volumes halved `halvings` times.
    pub fn with_halved_steps(&self, halvings: usize) -> Scene {
        let share = powu(0.5, halvings as u32);
        self.with_volumes(|volume| {
            volume.edit_volumes(|volume| {
                volume.step *= share;
                true
            });
        })
    }

    /// Reads the scene file at `path` and the files it names.
    pub fn load(path: &Path) -> SceneResult<Scene> {
        Scene::parse(&Scene::text(path)?, path)
    }

    /// The text of the scene file at `path`.
    fn text(path: &Path) -> SceneResult<String> {
        let name = path.display().to_string();
        let help = "give the path of a scene file; `volref render` shows a volume as it is";
        let nowhere = Document {
            path: &name,
            text: "",
        };
        let mistake = |message: String| nowhere.error(None, message, Some(help.to_owned()));
        // A description of bare samples ends in .toml, as scenes do.
        let is_toml = path
            .extension()
            .is_some_and(|extension| extension.eq_ignore_ascii_case("toml"));
        if !is_toml && volume_format(path).is_some() {
            return Err(mistake("this is a volume, not a scene".to_owned()));
        }
        let bytes = regular_file::read(path, MOST_BYTES)
            .map_err(|error| mistake(format!("cannot read the scene: {error}")))?;
        String::from_utf8(bytes).map_err(|_| mistake("the scene is not UTF-8 text".into()))
    }

    /// Reads a scene from `text`; `path` names it in messages, and paths in the scene are relative
    /// to its folder.
    pub fn parse(text: &str, path: &Path) -> SceneResult<Scene> {
        let name = path.display().to_string();
        let document = Document { path: &name, text };
        let root = document.parse()?;
        let mut files = Files::new(path.parent().unwrap_or(Path::new("")));
        let whole = root.span();
        let tables = panel_tables(&document, root)?;
        let lines = Lines::of(text);
        let read = |table| Panel::read(&document, &lines, table, &mut files);
        let panels = tables.iter().map(read).collect::<SceneResult<Vec<_>>>()?;
        let mut heights = panels.iter().map(|panel| panel.height);
        if let Some(odd) = heights.position(|height| height != panels[0].height) {
            let message = format!(
                "panels are side by side and must have the same height, but this one has {} rows, and the first {}",
                panels[odd].height, panels[0].height
            );
            return Err(document.error(Some(tables[odd].span()), message, None));
        }
        let pixels: usize = panels.iter().map(|panel| panel.width * panel.height).sum();
        if pixels > MOST_PIXELS {
            let message =
                format!("{pixels} pixels are too many; at most {MOST_PIXELS} are rendered");
            return Err(document.error(Some(whole), message, None));
        }
        Ok(Scene { panels })
    }

    /// Bytes of the values of all volumes; one that several panels or media share counts once.
    pub fn volume_bytes(&self) -> u64 {
        let grids: BTreeMap<*const Grid<f32>, usize> = self
            .panels
            .iter()
            .flat_map(|panel| panel.model.grids())
            .map(|grid| (Arc::as_ptr(grid), size_of_val(grid.values())))
            .collect();
        grids.values().map(|&bytes| bytes as u64).sum()
    }

    /// The scene as text that changes with any change of the image, except for the contents of the
    /// files it names: every key with its value, defaults included.
    pub fn canonical_text(&self) -> String {
        let mut text = String::new();
        for panel in &self.panels {
            text.push_str("[panel]\n");
            let readings = panel.readings.iter();
            for reading in readings.filter(|reading| reading.key != "title") {
                let value = match reading.origin {
                    // Follows from the other keys and the files: neither its digits nor the
                    // wording of the rule are the scene's.
                    Origin::Derived(_) => "derived",
                    Origin::Given | Origin::Default => &reading.value,
                };
                text.push_str(&format!("{} = {value}\n", reading.key));
            }
        }
        text
    }

    /// The seed of the first panel that may need random numbers.
    pub fn seed(&self) -> Option<u64> {
        self.panels.iter().find_map(|panel| match &panel.model {
            Model::Radiative(radiative) => Some(radiative.seed),
            Model::Classified(_) | Model::Curve(_) => None,
        })
    }

    /// Columns of pixels of the whole picture.
    pub fn width(&self) -> usize {
        self.panels.iter().map(|panel| panel.width).sum()
    }

    /// Rows of pixels, the same in all panels.
    pub fn height(&self) -> usize {
        self.panels[0].height
    }
}

/// The root table of each panel: the scene itself, or the scene with the panel's keys put in.
fn panel_tables<'s>(
    document: &Document<'s>,
    mut root: Spanned<DeTable<'s>>,
) -> SceneResult<Vec<Spanned<DeTable<'s>>>> {
    let Some(panels) = root.get_mut().remove("panel") else {
        return Ok(vec![root]);
    };
    let base = root.into_inner();
    let not_tables = |span| {
        let message = "`panel` must be tables in double brackets, [[panel]]";
        document.error(Some(span), message, None)
    };
    let items = match panels.get_ref() {
        DeValue::Array(items) if !items.is_empty() => items,
        _ => return Err(not_tables(panels.span())),
    };
    // Each panel holds what the scene does.
    let bytes = document.text.len().saturating_mul(items.len());
    if items.len() > MOST_PANELS || bytes > MOST_BYTES_OF_PANELS {
        let message = format!(
            "{} panels of a scene this long are too many: at most {MOST_PANELS}, and {MOST_BYTES_OF_PANELS} bytes of all, \
             are read",
            items.len()
        );
        let help = "render the others from a scene of their own".to_owned();
        return Err(document.error(Some(items[0].span()), message, Some(help)));
    }
    let table = |item: &Spanned<DeValue<'s>>| match item.get_ref() {
        DeValue::Table(over) if over.contains_key("panel") => {
            Err(document.error(Some(item.span()), "a panel cannot contain panels", None))
        }
        DeValue::Table(over) => Ok(Spanned::new(item.span(), overridden(&base, over))),
        _ => Err(not_tables(item.span())),
    };
    items.iter().map(table).collect()
}

impl Panel {
    /// An image of `model`, without a file, `width` columns by `height` rows.
    pub fn of(model: Model, [width, height]: [usize; 2]) -> Panel {
        Panel {
            title: None,
            width,
            height,
            model,
            fault: None,
            inputs: vec![],
            readings: vec![],
            key_lines: KeyLines::default(),
        }
    }

    fn read<'s>(
        document: &Document<'s>,
        lines: &Lines,
        table: &Spanned<DeTable<'s>>,
        files: &mut Files,
    ) -> SceneResult<Panel> {
        let log: RefCell<Vec<Reading>> = RefCell::default();
        let root = Reader::new(document, &SCENE, table, &log)?;
        let title = root.get("title")?;
        let film = Film::read(&root.table_or_default("film")?)?;
        let size = [film.width, film.height].map(|pixels| pixels as usize);
        let model = if let Some(reader) = root.table("classified")? {
            let classified = read_classified(&root, &reader, files, size)?;
            if classified.has_objects() {
                // Keys that several volumes share were read for each.
                let mut known = BTreeSet::new();
                log.borrow_mut()
                    .retain(|reading| known.insert(reading.key.clone()));
            }
            classified.into()
        } else if let Some(reader) = root.table("radiative")? {
            Radiative::read(&root, &reader, files, size)?.into()
        } else {
            let reader = root.table("curve")?.expect("one of the models");
            Model::Curve(Curve::read(&root, &reader)?)
        };
        Ok(Panel {
            title,
            inputs: files.take_used(),
            readings: log.into_inner(),
            key_lines: KeyLines::of(lines, table.get_ref()),
            ..Panel::of(model, size)
        })
    }
}

/// The remedy for values that are no densities.
const OTHER_VALUES: &str = "for other values, give their `range` in [transfer_function], or [[transfer_function.point]] \
                            with `value`, `colour` and `opacity`, once for each point of a table";

fn read_classified(
    root: &Reader,
    reader: &Reader,
    files: &mut Files,
    size: [usize; 2],
) -> SceneResult<Classified> {
    let tables = reader.one_or_more("volume")?;
    check_count(reader, "volume", tables.len())?;
    let without_own = tables.iter().find(|table| !table.has("transfer_function"));
    let shared = root.table_or_default("transfer_function")?;
    let shared_opacity = without_own.map(|_| OpacityByValue::read(&shared));
    let shared_opacity = shared_opacity.transpose()?;
    let has_other_colours = reader.has("window") || reader.has("isosurface");
    let mut volumes: Vec<VolumeTable> = Vec::new();
    for volume in &tables {
        let own = volume.table("transfer_function")?;
        let opacity = match &own {
            Some(own) => OpacityByValue::read(own)?,
            None => shared_opacity
                .clone()
                .expect("some volume has none of its own"),
        };
        let placed = files.placed_values(volume)?;
        let table = own.as_ref().unwrap_or(&shared);
        let range = match opacity {
            OpacityByValue::Formula(_) if !has_other_colours => {
                let is_shared = own.is_none() && tables.len() > 1;
                let is_sum = reader.says("mode", "sum");
                read_range(table, volume, is_shared, &placed, is_sum)?
            }
            _ => None,
        };
        if range.is_none() && !has_other_colours && !table.has("point") {
            Files::check_densities(volume, &placed.grid, OTHER_VALUES)?;
        }
        if let Some(nodes) = placed.grid.lattice().nodes().iter().max() {
            volume.resolved("resolution", nodes);
        }
        let name = volume.get::<Option<String>>("name")?;
        refuse! { volume:
            "name" if volumes.iter().any(|other| other.name == name), "another volume has this name, too",
                "give each volume a name of its own";
        }
        volumes.push(VolumeTable {
            reader: volume,
            name,
            bounds: placed.extent().world_bounds(),
            volume: Volume {
                transfer_function: read_transfer_function(table, opacity, range, placed.voxel())?,
                modulation: Modulation::read(volume, &placed, files)?,
                grid: placed.grid,
                to_world: placed.to_world,
                step: f64::NAN,
                phong: None,
                shadow: None,
            },
        });
    }
    let camera = root.table_or_default("camera")?;
    Classified::read(reader, &camera, volumes, files, size)
}
