//! What the office is made of: reflectances in linear Rec. 709.

use crate::glb::{Material, Model};
use crate::pictures;

/// Colours of book covers.
pub const COVERS: usize = 9;

/// Indices of the office's materials.
pub struct Palette {
    /// Ceiling, ρ = 0.8.
    pub ceiling: usize,
    /// Walls, ρ ≈ 0.66.
    pub wall: usize,
    /// The accent wall, a soft blue-green, ρ ≈ 0.6.
    pub accent: usize,
    /// Oak floor, ρ ≈ 0.25.
    pub floor: usize,
    /// Painted wood.
    pub trim: usize,
    /// Birch desk tops, ρ ≈ 0.4.
    pub birch: usize,
    /// Pale shelves.
    pub shelf: usize,
    /// Powder-coated steel.
    pub steel: usize,
    /// Dark plastic.
    pub plastic: usize,
    /// Key caps.
    pub keys: usize,
    /// Rug.
    pub rug: usize,
    /// Dividers: red, yellow, blue, green.
    pub dividers: [usize; 4],
    /// Fabric of the movable chair.
    pub orange: usize,
    /// Fabric of the other chairs.
    pub slate: usize,
    /// Book covers.
    pub covers: [usize; COVERS],
    /// Paper.
    pub paper: usize,
    /// Glazed stoneware.
    pub stoneware: usize,
    /// Glazed stoneware, turquoise.
    pub turquoise: usize,
    /// Clay of flower pots.
    pub clay: usize,
    /// Earth, coffee.
    pub earth: usize,
    /// Leaves, lit from both sides.
    pub leaf: usize,
    /// Three paintings.
    pub paintings: [usize; 3],
    /// What the monitors show.
    pub screen: usize,
    /// Lacquered lamp metal.
    pub lacquer: usize,
}

impl Palette {
    /// Adds the materials to a model.
    pub fn new(model: &mut Model) -> Self {
        let mut plain = |name, reflectance| model.material(Material::new(name, reflectance));
        let ceiling = plain("Ceiling paint", [0.80, 0.80, 0.79]);
        let wall = plain("Wall paint", [0.69, 0.66, 0.60]);
        let accent = plain("Accent paint", [0.50, 0.62, 0.62]);
        let trim = plain("Painted wood", [0.72, 0.71, 0.68]);
        let birch = plain("Birch", [0.50, 0.39, 0.27]);
        let shelf = plain("Ash", [0.60, 0.53, 0.43]);
        let steel = plain("Powder-coated steel", [0.42, 0.43, 0.45]);
        let plastic = plain("Dark plastic", [0.05, 0.05, 0.055]);
        let keys = plain("Key caps", [0.22, 0.22, 0.23]);
        let rug = plain("Rug", [0.30, 0.31, 0.36]);
        let dividers = [
            plain("Red felt", [0.62, 0.06, 0.045]),
            plain("Yellow felt", [0.76, 0.53, 0.04]),
            plain("Blue felt", [0.05, 0.15, 0.58]),
            plain("Green felt", [0.09, 0.44, 0.10]),
        ];
        let orange = plain("Orange fabric", [0.66, 0.20, 0.035]);
        let slate = plain("Slate fabric", [0.11, 0.14, 0.19]);
        let covers = [
            plain("Cover, brick", [0.48, 0.09, 0.06]),
            plain("Cover, ochre", [0.60, 0.38, 0.08]),
            plain("Cover, navy", [0.04, 0.08, 0.26]),
            plain("Cover, forest", [0.05, 0.22, 0.10]),
            plain("Cover, cream", [0.70, 0.65, 0.52]),
            plain("Cover, sky", [0.20, 0.42, 0.60]),
            plain("Cover, charcoal", [0.07, 0.07, 0.08]),
            plain("Cover, plum", [0.25, 0.06, 0.20]),
            plain("Cover, white", [0.75, 0.75, 0.73]),
        ];
        let paper = plain("Paper", [0.78, 0.78, 0.76]);
        let stoneware = plain("White stoneware", [0.74, 0.73, 0.70]);
        let turquoise = plain("Turquoise stoneware", [0.06, 0.42, 0.42]);
        let clay = plain("Clay", [0.48, 0.21, 0.12]);
        let earth = plain("Earth", [0.06, 0.04, 0.03]);
        let lacquer = plain("Cream lacquer", [0.70, 0.67, 0.60]);
        let leaf =
            model.material(Material { double_sided: true, ..Material::new("Leaf", [0.10, 0.33, 0.07]) });
        let mut pictured = |name, factor: f64, png| {
            let picture = Some(model.picture(png));
            model.material(Material { picture, ..Material::new(name, [factor; 3]) })
        };
        let floor = pictured("Oak planks", 1.0, pictures::planks());
        let paintings = [
            pictured("Painting, hills", 0.9, pictures::hills()),
            pictured("Painting, bars", 0.9, pictures::bars()),
            pictured("Painting, rings", 0.9, pictures::rings()),
        ];
        let screen = pictured("Screen", 0.9, pictures::page());
        Self {
            ceiling,
            wall,
            accent,
            floor,
            trim,
            birch,
            shelf,
            steel,
            plastic,
            keys,
            rug,
            dividers,
            orange,
            slate,
            covers,
            paper,
            stoneware,
            turquoise,
            clay,
            earth,
            leaf,
            paintings,
            screen,
            lacquer,
        }
    }
}
