//! Colours beside an opacity, without the background behind them.

use super::Film;
use std::fmt;
use std::str::FromStr;

/// Whether colours without the background are multiplied by the opacity beside them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alpha {
    /// Multiplied by opacity: the light that the volume sends.
    Premultiplied,
    /// Not multiplied by opacity, as in PNG.
    Straight,
}

impl fmt::Display for Alpha {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Alpha::Premultiplied => "premultiplied",
            Alpha::Straight => "straight",
        })
    }
}

impl FromStr for Alpha {
    type Err = String;

    fn from_str(text: &str) -> Result<Alpha, String> {
        match text {
            "premultiplied" => Ok(Alpha::Premultiplied),
            "straight" => Ok(Alpha::Straight),
            _ => Err(
                "colours beside an opacity are premultiplied or straight, without the background; leave --alpha out \
                 for radiance that contains it"
                    .to_owned(),
            ),
        }
    }
}

impl Film {
    /// Composites an image of this kind over the `background` of each pixel; an image without opacity stays as it is.
    ///
    /// Source: Porter & Duff 1984, "Compositing digital images" (the operator *over*).
    pub fn before(mut self, alpha: Alpha, background: impl Fn(usize) -> [f64; 3]) -> Film {
        let Some(opacity) = &self.opacity else {
            return self;
        };
        for (index, (pixel, &opacity)) in self.radiance.iter_mut().zip(opacity).enumerate() {
            let opacity = f64::from(opacity);
            let factor = match alpha {
                Alpha::Premultiplied => 1.0,
                Alpha::Straight => opacity,
            };
            let behind = background(index);
            *pixel = [0, 1, 2]
                .map(|c| (factor * f64::from(pixel[c]) + (1.0 - opacity) * behind[c]) as f32);
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grey_pane_before_red() {
        let film = |grey: f32| Film::with_opacity(1, 1, vec![[grey, grey, grey, 0.75]]);
        let before = |film: Film, alpha| film.before(alpha, |_| [1.0, 0.0, 0.0]).radiance()[0];
        let expected = [0.625, 0.375, 0.375];
        assert_eq!(before(film(0.375), Alpha::Premultiplied), expected);
        assert_eq!(before(film(0.5), Alpha::Straight), expected);
        let opaque = Film::new(1, 1, vec![[0.5; 3]]);
        assert_eq!(before(opaque, Alpha::Straight), [0.5; 3]);
    }
}
