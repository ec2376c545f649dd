//! Indirect light of chosen bounces: of light paths L D D E the second, and so on.
//!
//! Direct irradiance D is b₀, and each sweep of the transport makes one bounce of the one before, bⱼ₊₁ = T ρ bⱼ;
//! what the solver found is the sum of all of them. So any choice costs as many sweeps as it names bounces.

use super::{RadiositySolution, reflected, smooth};
use crate::reference::expression::Bounces;
use glam::Vec3;

impl RadiositySolution {
    /// The solution whose indirect light is that of some bounces only, to be shown and not to be lit again; `None`
    /// where specular lobes pass light on, whose paths are not told apart here.
    pub fn of_bounces(&self, bounces: &Bounces) -> Option<Self> {
        let transport = &self.transport;
        if transport.lobes.any() {
            return None;
        }
        let elements = self.elements();
        let bounce = |irradiance: &[Vec3]| {
            let nothing = vec![Vec3::ZERO; irradiance.len()];
            let radiosity = reflected(elements, irradiance, &nothing);
            let mut next = transport.gather(&radiosity);
            transport.fill(&mut next);
            (radiosity, next)
        };
        // A path of k reflections ends with the one of b at k − 1, so it begins, before its last sweep, with k − 2.
        let mut chosen: Vec<Vec3> = match bounces.rest {
            true => self.direct.iter().zip(&self.gathered).map(|(d, g)| *d + *g).collect(),
            false => vec![Vec3::ZERO; elements.len()],
        };
        let mut b = self.direct.clone();
        for (k, &counted) in bounces.counted.iter().enumerate().skip(2) {
            if counted != bounces.rest {
                let sign = if counted { 1.0 } else { -1.0 };
                chosen.iter_mut().zip(&b).for_each(|(sum, b)| *sum += sign * *b);
            }
            if k + 1 < bounces.counted.len() {
                b = bounce(&b).1;
            }
        }
        // Differences may fall below zero by rounding.
        chosen.iter_mut().for_each(|e| *e = e.max(Vec3::ZERO));
        let (radiosity, mut indirect) = bounce(&chosen);
        if self.settings.smoothing > 0.0 {
            let variances = smooth::variances(transport, &radiosity);
            indirect = smooth::smooth(transport, &indirect, &variances, self.settings.smoothing);
            transport.fill(&mut indirect);
        }
        Some(Self { indirect, radiosity, ..self.clone() })
    }
}
