//! Speed against accuracy: which settings are worth their cost, and how much one method saves over another.
//!
//! A curve is a list of (cost, error), one a setting. Costs and errors span decades and fall about as powers of
//! each other, so everything between settings is interpolated in logarithms.

/// Cost of a setting, seconds or elements, and its error.
pub type Point = [f64; 2];

/// Settings that no other one beats: the Pareto front, cheapest first, as indices. Of equals the first counts;
/// what is not a positive number stands nowhere.
pub fn front(points: &[Point]) -> Vec<usize> {
    let positive = |p: &Point| p.iter().all(|v| v.is_finite() && *v > 0.0);
    let mut order: Vec<usize> = (0..points.len()).filter(|&i| positive(&points[i])).collect();
    order.sort_by(|&a, &b| points[a][0].total_cmp(&points[b][0]).then(points[a][1].total_cmp(&points[b][1])));
    let mut least = f64::INFINITY;
    order.retain(|&i| {
        let better = points[i][1] < least;
        least = least.min(points[i][1]);
        better
    });
    order
}

/// Cost at which a curve first comes down to an error: log-log linear between the settings of its front; `None`
/// for errors that it does not span.
pub fn cost_at(curve: &[Point], error: f64) -> Option<f64> {
    let front: Vec<Point> = front(curve).into_iter().map(|i| curve[i]).collect();
    if let Some([cost, _]) = front.iter().find(|p| p[1] == error) {
        return Some(*cost);
    }
    front.windows(2).find(|w| w[0][1] > error && w[1][1] < error).map(|w| {
        let [[x0, y0], [x1, y1]] = [w[0], w[1]].map(|p| p.map(f64::ln));
        (x0 + (error.ln() - y0) / (y1 - y0) * (x1 - x0)).exp()
    })
}

/// How many times the cost of another curve one has, at equal error.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Saving {
    /// Geometric mean of the ratio over the errors that both curves reach.
    pub factor: f64,
    /// Its least value there.
    pub least: f64,
    /// Its largest.
    pub most: f64,
    /// The errors: smallest and largest.
    pub errors: [f64; 2],
}

/// Errors at which two curves are compared.
const STEPS: u32 = 64;

/// Cost of `dear` over cost of `cheap` at equal error; `None` where they reach no error in common.
pub fn saving(dear: &[Point], cheap: &[Point]) -> Option<Saving> {
    let reach = |curve: &[Point]| -> Option<[f64; 2]> {
        let front = front(curve);
        Some([curve[*front.last()?][1], curve[*front.first()?][1]])
    };
    let (a, b) = (reach(dear)?, reach(cheap)?);
    let errors = [a[0].max(b[0]), a[1].min(b[1])];
    if errors[0] > errors[1] {
        return None;
    }
    let ratios = (0..=STEPS).filter_map(|i| {
        let t = f64::from(i) / f64::from(STEPS);
        let error = match i {
            0 => errors[0],
            STEPS => errors[1],
            _ => (errors[0].ln() * (1.0 - t) + errors[1].ln() * t).exp(),
        };
        Some(cost_at(dear, error)? / cost_at(cheap, error)?)
    });
    let ratios: Vec<f64> = ratios.collect();
    Some(Saving {
        factor: (ratios.iter().map(|r| r.ln()).sum::<f64>() / ratios.len() as f64).exp(),
        least: ratios.iter().copied().fold(f64::INFINITY, f64::min),
        most: ratios.iter().copied().fold(0.0, f64::max),
        errors,
    })
    .filter(|s| s.factor.is_finite())
}
