//! The examples that come with the program.

use anyhow::{Context as _, Result};
use std::path::{Path, PathBuf};

/// An example scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Example {
    /// A furnished office, lit mostly by an uplighter: the scene shown at first.
    Office,
    /// The Cornell box.
    Cornell,
    /// A teapot on a glossy table.
    Teapot,
    /// The same table with Phong's lobe.
    Phong,
    /// The same teapot in chrome.
    Chrome,
    /// A pyramid of copper on a mirror.
    Pyramid,
    /// A ball, a block and a pane of glass.
    Glass,
    /// A house with a music room: five mirrors.
    House,
    /// The Cornell box with its radiosity on quadtrees.
    Quadtrees,
    /// The Cornell box with a ball.
    Ball,
    /// Four walls of constant radiance.
    FourWalls,
    /// A lit and a dark room divided by a thin wall.
    TwoRooms,
    /// A tunnel lit from one end.
    Tunnel,
    /// A dark box in a lit room.
    ClosedBox,
    /// A point lamp over a floor.
    PointOverFloor,
    /// A rectangular lamp over a floor.
    RectangleOverFloor,
    /// A cube whose walls emit and reflect alike.
    Furnace,
}

/// Files of the source tree's scenes, by their paths there, and contents built into the program.
macro_rules! scene_files {
    ($($path:literal),+) => {
        vec![$(($path, include_bytes!(concat!("../../scenes/", $path)).as_slice())),+]
    };
}

impl Example {
    /// Examples to look at, in the order they are offered.
    pub const ALL: [Self; 10] = [
        Self::Office,
        Self::Cornell,
        Self::Quadtrees,
        Self::Ball,
        Self::Teapot,
        Self::Phong,
        Self::Chrome,
        Self::Pyramid,
        Self::Glass,
        Self::House,
    ];

    /// Examples whose light is known in closed form, or known to be hard.
    pub const ANALYTIC: [Self; 7] = [
        Self::FourWalls,
        Self::TwoRooms,
        Self::Tunnel,
        Self::ClosedBox,
        Self::PointOverFloor,
        Self::RectangleOverFloor,
        Self::Furnace,
    ];

    /// Every example.
    pub fn every() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().chain(Self::ANALYTIC)
    }

    /// Title on buttons.
    pub fn title(self) -> &'static str {
        match self {
            Self::Office => "Office",
            Self::Cornell => "Cornell box",
            Self::Teapot => "Teapot on a glossy table",
            Self::Phong => "Teapot on a table of Phong's",
            Self::Chrome => "Chrome teapot",
            Self::Pyramid => "Copper pyramid",
            Self::Glass => "Things of glass",
            Self::House => "House with a music room",
            Self::Quadtrees => "Cornell box on quadtrees",
            Self::Ball => "Cornell box with a ball",
            Self::FourWalls => "Four constant walls",
            Self::TwoRooms => "Two rooms, one dark",
            Self::Tunnel => "Tunnel",
            Self::ClosedBox => "Closed box",
            Self::PointOverFloor => "Point lamp over a floor",
            Self::RectangleOverFloor => "Rectangular lamp over a floor",
            Self::Furnace => "Furnace",
        }
    }

    /// What it is good for.
    pub fn hint(self) -> &'static str {
        match self {
            Self::Office => "A furnished room lit by an uplighter: most of its light is indirect.",
            Self::Cornell => "Two blocks between a red and a green wall: colour bleeding at its plainest.",
            Self::Teapot => {
                "A glossy table between a teapot and a chequered wall: reflections blur with distance."
            }
            Self::Phong => {
                "A round lobe blurs alike in every direction; microfacets draw out what is seen aslant."
            }
            Self::Chrome => "A curved reflector: it shows a map of the light around its middle.",
            Self::Pyramid => {
                "Flat mirrors of copper: reflectance that grows and pales towards grazing angles."
            }
            Self::Glass => "A ball and a block bend what is behind them, a pane colours it and the light.",
            Self::House => {
                "A grand piano among five flat mirrors and 180,000 triangles: mirrored views and what they cost."
            }
            Self::Quadtrees => {
                "Elements split level by level where light bends: see Edges and T-vertices among the views."
            }
            Self::Ball => {
                "A ball whose light is one texture by longitude and latitude: click it with Texture open."
            }
            Self::FourWalls => "Radiance 4, 3, 2 and 1 cd/m²: spheres that can be checked by hand.",
            Self::TwoRooms => "A wall 2 cm thick between light and dark: where a volume leaks.",
            Self::Tunnel => "Light dies off along it and is never 0.",
            Self::ClosedBox => "Samples inside walls, and a place that no light reaches.",
            Self::PointOverFloor => "E = I cos θ / d²: 100 lx under the lamp.",
            Self::RectangleOverFloor => "A form factor in closed form: 203.63 lx under the lamp's middle.",
            Self::Furnace => {
                "Radiance Le / (1 − ρ) = 1 cd/m² everywhere: light that cannot be seen by contrast."
            }
        }
    }

    /// Name in a session file: `example:NAME`.
    pub fn key(self) -> &'static str {
        match self {
            Self::Office => "example:office",
            Self::Cornell => "example:cornell",
            Self::Teapot => "example:teapot",
            Self::Phong => "example:phong",
            Self::Chrome => "example:chrome",
            Self::Pyramid => "example:pyramid",
            Self::Glass => "example:glass",
            Self::House => "example:house",
            Self::Quadtrees => "example:quadtrees",
            Self::Ball => "example:ball",
            Self::FourWalls => "example:four_walls",
            Self::TwoRooms => "example:two_rooms",
            Self::Tunnel => "example:tunnel",
            Self::ClosedBox => "example:closed_box",
            Self::PointOverFloor => "example:point_over_floor",
            Self::RectangleOverFloor => "example:rectangle_over_floor",
            Self::Furnace => "example:furnace",
        }
    }

    /// Its files: path under `scenes/`, and contents; the scene first.
    fn files(self) -> Vec<(&'static str, &'static [u8])> {
        match self {
            Self::Office => scene_files!["office/office.ron", "office/office.glb"],
            Self::Cornell => scene_files!["cornell/cornell.ron", "cornell/cornell.glb"],
            Self::Quadtrees => scene_files!["cornell/quadtrees.ron", "cornell/cornell.glb"],
            Self::Ball => scene_files!["cornell/ball.ron", "cornell/ball.glb", "cornell/cornell.glb"],
            Self::Teapot => scene_files!["glossy/teapot.ron", "glossy/teapot.glb"],
            Self::Phong => scene_files!["glossy/phong.ron", "glossy/teapot.glb"],
            Self::Chrome => scene_files!["glossy/chrome.ron", "glossy/chrome.glb"],
            Self::Pyramid => scene_files!["mirror/pyramid.ron", "mirror/pyramid.glb"],
            Self::Glass => scene_files!["glass/glass.ron", "glass/glass.glb"],
            Self::House => {
                scene_files!["house/house.ron", "house/music_room.glb", "house/living_room.glb"]
            }
            Self::FourWalls => scene_files!["analytic/four_walls.ron", "analytic/four_walls.glb"],
            Self::TwoRooms => scene_files!["analytic/two_rooms.ron", "analytic/two_rooms.glb"],
            Self::Tunnel => scene_files!["analytic/tunnel.ron", "analytic/tunnel.glb"],
            Self::ClosedBox => scene_files!["analytic/closed_box.ron", "analytic/closed_box.glb"],
            Self::PointOverFloor => {
                scene_files!["analytic/point_over_floor.ron", "analytic/point_over_floor.glb"]
            }
            Self::RectangleOverFloor => {
                scene_files!["analytic/rectangle_over_floor.ron", "analytic/rectangle_over_floor.glb"]
            }
            Self::Furnace => scene_files!["analytic/furnace_box_0_9.ron", "analytic/furnace_box_0_9.glb"],
        }
    }

    /// Its scene file: in the source tree where there is one, else unpacked into the user's cache.
    ///
    /// # Errors
    /// With the file's name, if it cannot be unpacked.
    pub fn path(self) -> Result<PathBuf> {
        let files = self.files();
        let scene = files[0].0;
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes").join(scene);
        if source.exists() {
            return Ok(source);
        }
        let cache = directories::ProjectDirs::from("", "", "lumenscope")
            .map_or_else(|| std::env::temp_dir().join("lumenscope"), |d| d.cache_dir().to_path_buf());
        let root = cache.join(concat!("examples-", env!("CARGO_PKG_VERSION")));
        for (path, bytes) in files {
            let path = root.join(path);
            let folder = path.parent().unwrap_or(&root);
            std::fs::create_dir_all(folder)
                .with_context(|| format!("{}: the example cannot be unpacked", folder.display()))?;
            lumenscope_core::io::write_file(&path, bytes)?;
        }
        Ok(root.join(scene))
    }
}

/// The scene shown where none is asked for.
///
/// # Errors
/// With the file's name, if it cannot be unpacked.
pub fn office() -> Result<PathBuf> {
    Example::Office.path()
}

/// The Cornell box's scene file.
///
/// # Errors
/// With the file's name, if it cannot be unpacked.
pub fn cornell() -> Result<PathBuf> {
    Example::Cornell.path()
}

/// The file to read for a document's scene: an example's file for `example:NAME`, else the path itself.
///
/// # Errors
/// With the file's name, if an example cannot be unpacked.
pub fn resolve(scene: &Path) -> Result<PathBuf> {
    match Example::every().find(|e| Path::new(e.key()) == scene) {
        Some(example) => example.path(),
        None => Ok(scene.to_path_buf()),
    }
}
