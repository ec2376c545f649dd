//! What the house is made of: reflectances in linear Rec. 709.

use crate::glb::{Material, Model};
use crate::office::palette::COVERS;
use crate::pictures;

/// Indices of the house's materials.
pub struct Palette {
    /// Ceilings, ρ = 0.8.
    pub ceiling: usize,
    /// Walls of the music room, a warm green-grey.
    pub sage: usize,
    /// Walls of the living room.
    pub cream: usize,
    /// Wall behind the stair.
    pub ochre: usize,
    /// Parquet of the music room under lacquer, slightly glossy.
    pub parquet: usize,
    /// Planks of the living room, dull.
    pub planks: usize,
    /// White painted wood.
    pub trim: usize,
    /// Walnut.
    pub walnut: usize,
    /// Oak.
    pub oak: usize,
    /// Dull black lacquer: the piano's sides.
    pub ebony: usize,
    /// Polished black lacquer: the piano's lid.
    pub lid: usize,
    /// Polished mahogany: the bench's top.
    pub bench: usize,
    /// Silvered glass of the door.
    pub door_glass: usize,
    /// Silvered glass of the framed mirror.
    pub mirror_glass: usize,
    /// Gilt.
    pub gilt: usize,
    /// Brass, dull.
    pub brass: usize,
    /// Ivory keys.
    pub ivory: usize,
    /// A page of music.
    pub music: usize,
    /// Rug.
    pub rug: usize,
    /// Plain felt, red.
    pub felt: usize,
    /// Upholstery: sofa, armchair, cushions.
    pub upholstery: [usize; 3],
    /// Curtains, lit from both sides.
    pub curtain: usize,
    /// Clay, earth and leaf of plants.
    pub pot: [usize; 3],
    /// Glazed porcelain.
    pub porcelain: usize,
    /// Cobalt glaze.
    pub cobalt: usize,
    /// Lamp shades of cloth, lit from both sides.
    pub shade: usize,
    /// Candles.
    pub wax: usize,
    /// Paintings.
    pub paintings: [usize; 3],
    /// Book covers.
    pub covers: [usize; COVERS],
}

impl Palette {
    /// Adds the materials to a model.
    pub fn new(model: &mut Model) -> Self {
        let mut plain = |name, reflectance| model.material(Material::new(name, reflectance));
        let covers = [
            plain("Calf, red", [0.36, 0.08, 0.05]),
            plain("Calf, tan", [0.48, 0.29, 0.12]),
            plain("Cloth, navy", [0.05, 0.08, 0.22]),
            plain("Cloth, green", [0.06, 0.20, 0.10]),
            plain("Vellum", [0.68, 0.61, 0.46]),
            plain("Cloth, sky", [0.24, 0.38, 0.52]),
            plain("Calf, black", [0.06, 0.05, 0.05]),
            plain("Cloth, plum", [0.24, 0.07, 0.17]),
            plain("Paper boards", [0.70, 0.68, 0.62]),
        ];
        let ceiling = plain("Ceiling white", [0.80, 0.79, 0.77]);
        let sage = plain("Sage paint", [0.52, 0.58, 0.50]);
        let cream = plain("Cream paint", [0.74, 0.68, 0.57]);
        let ochre = plain("Ochre paint", [0.70, 0.50, 0.26]);
        let trim = plain("White gloss paint", [0.74, 0.73, 0.70]);
        let walnut = plain("Walnut", [0.22, 0.12, 0.065]);
        let oak = plain("Oak", [0.42, 0.29, 0.17]);
        let ebony = plain("Ebony lacquer", [0.030, 0.028, 0.028]);
        let gilt = plain("Gilt", [0.62, 0.43, 0.15]);
        let brass = plain("Brass", [0.55, 0.40, 0.17]);
        let ivory = plain("Ivory", [0.74, 0.71, 0.62]);
        let felt = plain("Red felt runner", [0.42, 0.06, 0.05]);
        let upholstery = [
            plain("Sofa, petrol", [0.07, 0.22, 0.25]),
            plain("Armchair, rust", [0.50, 0.18, 0.07]),
            plain("Cushion, mustard", [0.66, 0.44, 0.08]),
        ];
        let porcelain = plain("Porcelain", [0.76, 0.75, 0.72]);
        let cobalt = plain("Cobalt glaze", [0.06, 0.12, 0.42]);
        let wax = plain("Wax", [0.78, 0.74, 0.64]);
        let (clay, earth) = (plain("Terracotta", [0.46, 0.20, 0.11]), plain("Soil", [0.06, 0.04, 0.03]));
        let mut polished = |name, reflectance, metallic, roughness| {
            model.material(Material::new(name, reflectance).polished(metallic, roughness))
        };
        let lid = polished("Polished black lacquer", [0.022, 0.020, 0.020], 0.0, 0.0);
        let bench = polished("Polished mahogany", [0.20, 0.065, 0.035], 0.0, 0.0);
        let door_glass = polished("Silvered glass, door", [0.86, 0.88, 0.86], 1.0, 0.0);
        let mirror_glass = polished("Silvered glass, framed", [0.88, 0.87, 0.84], 1.0, 0.0);
        let mut both = |name, reflectance| {
            model.material(Material { double_sided: true, ..Material::new(name, reflectance) })
        };
        let curtain = both("Linen curtain", [0.66, 0.56, 0.42]);
        let shade = both("Lamp shade", [0.72, 0.64, 0.50]);
        let leaf = both("House leaf", [0.09, 0.31, 0.08]);
        let mut pictured = |name, factor: f64, png, roughness| {
            let picture = Some(model.picture(png));
            let material = Material { picture, ..Material::new(name, [factor; 3]) };
            model.material(material.polished(0.0, roughness))
        };
        Self {
            parquet: pictured("Lacquered parquet", 0.95, pictures::parquet(), 0.08),
            planks: pictured("Oak boards", 1.0, pictures::planks(), 1.0),
            music: pictured("Sheet music", 0.9, pictures::staves(), 1.0),
            rug: pictured("Woven rug", 0.9, pictures::carpet(), 1.0),
            paintings: [
                pictured("Painting, hills", 0.9, pictures::hills(), 1.0),
                pictured("Painting, bars", 0.9, pictures::bars(), 1.0),
                pictured("Painting, rings", 0.9, pictures::rings(), 1.0),
            ],
            pot: [clay, earth, leaf],
            ceiling,
            sage,
            cream,
            ochre,
            trim,
            walnut,
            oak,
            ebony,
            lid,
            bench,
            door_glass,
            mirror_glass,
            gilt,
            brass,
            ivory,
            felt,
            upholstery,
            curtain,
            porcelain,
            cobalt,
            shade,
            wax,
            covers,
        }
    }
}
