//! Corner: where two straight flanks of a profile meet, rounded by an arc of a circle.

use asperity_numerics::elementary::{atan, cos, sin, tan};

/// An arc that is tangent to both flanks of a corner.
///
/// A radius of zero leaves the corner sharp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Corner {
    /// Start and end of the arc.
    pub(super) from: f64,
    pub(super) to: f64,
    /// Centre `[x, z]` of the circle.
    centre: [f64; 2],
    radius: f64,
    /// 1 where the material lies inside of the circle (a ridge), -1 where it lies outside (a valley).
    sign: f64,
}

impl Corner {
    /// At `vertex` `[x, z]`, between a flank of slope `slopes[0]` on the left and one of slope `slopes[1]` on the right.
    pub(super) fn new(vertex: [f64; 2], slopes: [f64; 2], radius: f64) -> Self {
        let [x, z] = vertex;
        let [left, right] = slopes.map(atan);
        let sign = if right < left { 1.0 } else { -1.0 };
        // Length of the tangents from the vertex to the arc
        let tangent = radius * tan(0.5 * (right - left).abs());
        let from = x - tangent * cos(left);
        let to = x + tangent * cos(right);
        let centre = [
            from + sign * radius * sin(left),
            z - tangent * sin(left) - sign * radius * cos(left),
        ];
        Self {
            from,
            to,
            centre,
            radius,
            sign,
        }
    }

    /// Height of the arc at `x`; `None` beside it.
    pub(super) fn height(&self, x: f64) -> Option<f64> {
        let Self {
            from,
            to,
            centre: [xc, zc],
            radius,
            sign,
        } = *self;
        (x > from && x < to).then(|| {
            let off = x - xc;
            zc + sign * (radius * radius - off * off).max(0.0).sqrt()
        })
    }
}

/// A groove with straight flanks in a plane at height zero, by the distance from its centre line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct VGroove {
    depth: f64,
    /// Slope of the flanks.
    slope: f64,
    half_width: f64,
    bottom: Corner,
    rim: Corner,
}

impl VGroove {
    /// Corner of the sharp groove's `depth` and `width` between its rims; rims and bottom are rounded by `edge_radius`.
    pub(super) fn new(depth: f64, width: f64, edge_radius: f64) -> Self {
        let half_width = 0.5 * width;
        let slope = depth / half_width;
        Self {
            depth,
            slope,
            half_width,
            bottom: Corner::new([0.0, -depth], [-slope, slope], edge_radius),
            rim: Corner::new([half_width, 0.0], [slope, 0.0], edge_radius),
        }
    }

    /// Largest edge radius whose arcs at rim and bottom do not overlap.
    pub(super) fn largest_edge_radius(depth: f64, width: f64) -> f64 {
        // Both ends grow in proportion to the radius
        let unit = Self::new(depth, width, 1.0);
        unit.half_width / (unit.bottom.to + unit.half_width - unit.rim.from)
    }

    /// Distance from the centre line that it reaches.
    pub(super) fn reach(&self) -> f64 {
        self.rim.to
    }

    /// Depth below the plane at a `distance` of zero or more.
    pub(super) fn depth_at(&self, distance: f64) -> f64 {
        if distance >= self.rim.to {
            return 0.0;
        }
        let arc = self.bottom.height(distance);
        let arc = arc.or_else(|| self.rim.height(distance));
        let straight = || self.slope * distance - self.depth;
        (-arc.unwrap_or_else(straight)).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At both ends of an arc its height and its slope are those of the flanks.
    #[test]
    fn arcs_are_tangent_to_both_flanks() {
        for slopes in [
            [0.5, -1.5],
            [-0.2, 0.7],
            [0.3, 0.9],
            [0.0, -2.0],
            [1.0, 0.0],
        ] {
            let [x, z] = [0.4, -0.3];
            let corner = Corner::new([x, z], slopes, 0.25);
            let off = 1e-7;
            for (end, inward, slope) in
                [(corner.from, off, slopes[0]), (corner.to, -off, slopes[1])]
            {
                let on_flank = z + slope * (end - x);
                let found = corner.height(end + inward).unwrap();
                // The arc's curvature, of up to (1 + m^2)^(3/2) / r = 45, times off^2, and rounding
                assert!(
                    (found - on_flank - slope * inward).abs() < 1e-12,
                    "{slopes:?}"
                );
            }
        }
    }

    #[test]
    fn rounded_grooves_are_continuous_up_to_the_largest_edge_radius() {
        let largest = VGroove::largest_edge_radius(0.7, 2.0);
        for radius in [0.0, 0.5 * largest, largest] {
            let groove = VGroove::new(0.7, 2.0, radius);
            assert!(groove.bottom.to <= groove.rim.from + 1e-12);
            let step = 1e-4;
            let mut last = groove.depth_at(0.0);
            for i in 1..20_000 {
                let depth = groove.depth_at(f64::from(i) * step);
                assert!(depth <= last + 1e-15 && last - depth < 0.7001 * step, "{i}");
                last = depth;
            }
            assert_eq!(groove.depth_at(groove.reach()), 0.0);
        }
    }
}
