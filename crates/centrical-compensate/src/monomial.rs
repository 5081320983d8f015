//! Monomials of the specific force: value, derivatives and text, the one place that knows their rules.

use core::fmt;

use crate::vectors::lanes::Lanes;

/// `f1^p1 f2^p2 f3^p3`, with the sign of a component if it is odd: `|f_j| f_j` is the square of `f_j` with the sign of
/// `f_j`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Monomial {
    /// Powers of `f1, f2, f3`.
    pub powers: [u8; 3],
    /// Component whose sign it takes, 0 to 2. Zero counts as positive.
    pub sign_of: Option<usize>,
}

impl Monomial {
    /// The constant 1.
    pub const ONE: Self = Self { powers: [0; 3], sign_of: None };

    /// `f_axis^power`.
    ///
    /// # Panics
    /// If `axis` is not 0, 1 or 2.
    pub const fn power(axis: usize, power: u8) -> Self {
        let mut powers = [0; 3];
        powers[axis] = power;
        Self { powers, sign_of: None }
    }

    /// `|f_axis| f_axis`.
    ///
    /// # Panics
    /// If `axis` is not 0, 1 or 2.
    pub const fn odd_square(axis: usize) -> Self {
        Self { sign_of: Some(axis), ..Self::power(axis, 2) }
    }

    /// The product of components, each as often as it is listed: `f1^2 f3` of `[0, 0, 2]`.
    ///
    /// # Panics
    /// If a component is not 0, 1 or 2.
    pub const fn product(components: &[usize]) -> Self {
        let mut powers = [0; 3];
        let mut n = 0;
        while n < components.len() {
            powers[components[n]] += 1;
            n += 1;
        }
        Self { powers, sign_of: None }
    }

    /// Of a text such as [`Display`](fmt::Display) writes; `None` of any other. An absolute value is the factor with its own sign: `|f| = sign(f) f`.
    pub fn parse(text: &str) -> Option<Self> {
        let mut monomial = Self::ONE;
        if text.trim() == "1" {
            return Some(monomial);
        }
        let mut absolute = [false; 3];
        for factor in text.split('*') {
            let (base, power) = factor.split_once('^').unwrap_or((factor, "1"));
            let power: u8 = power.trim().parse().ok().filter(|p| *p > 0)?;
            let base = base.trim();
            if let Some(signed) = base.strip_prefix("sgn(").and_then(|b| b.strip_suffix(')')) {
                let axis = ["f1", "f2", "f3"].iter().position(|name| *name == signed.trim())?;
                absolute[axis] ^= power % 2 == 1;
                continue;
            }
            let inner = base.strip_prefix('|').and_then(|b| b.strip_suffix('|'));
            let axis = ["f1", "f2", "f3"].iter().position(|name| *name == inner.unwrap_or(base).trim())?;
            monomial.powers[axis] = monomial.powers[axis].checked_add(power)?;
            absolute[axis] ^= inner.is_some() && power % 2 == 1;
        }
        let mut signs = (0..3).filter(|j| absolute[*j]);
        monomial.sign_of = signs.next();
        signs.next().is_none().then_some(monomial)
    }

    /// Sum of the powers.
    pub fn degree(&self) -> u16 {
        self.powers.into_iter().map(u16::from).sum()
    }

    /// Component and power, if it is a power of one component without a sign; the constant is a power 0 of the first.
    pub fn as_power(&self) -> Option<(usize, u8)> {
        let axis = self.powers.iter().position(|p| *p > 0).unwrap_or(0);
        let power = self.powers[axis];
        (self.sign_of.is_none() && self.degree() == power.into()).then_some((axis, power))
    }

    /// Value at `f` [m/s^2 to the degree].
    #[inline]
    pub fn value(&self, f: [f64; 3]) -> f64 {
        let sign = if self.sign_of.is_some_and(|j| f[j] < 0.0) { -1.0 } else { 1.0 };
        let [p1, p2, p3] = self.powers;
        sign * power(f[0], p1) * power(f[1], p2) * power(f[2], p3)
    }

    /// Derivatives by `f1, f2, f3` at `f`; at a kink, those of the positive side.
    #[inline]
    pub fn gradient(&self, f: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|j| self.derivative(j).map_or(0.0, |(factor, lower)| factor * lower.value(f)))
    }

    /// The derivative by component `j`: a number times a monomial. `None` where it is zero everywhere.
    #[inline(always)]
    pub fn derivative(&self, j: usize) -> Option<(f64, Self)> {
        let mut lower = *self;
        lower.powers[j] = self.powers[j].checked_sub(1)?;
        Some((self.powers[j].into(), lower))
    }

    /// `c` times the value at each of `W` specific forces: the factors in turn, each for all of them at once.
    #[inline(always)]
    pub(crate) fn values<const W: usize>(&self, c: f64, f: &Lanes<W>) -> [f64; W] {
        let mut values = match self.sign_of {
            None => [c; W],
            Some(j) => f.0[j].map(|f| if f < 0.0 { -c } else { c }),
        };
        for (f, power) in f.0.iter().zip(self.powers) {
            for _ in 0..power {
                for w in 0..W {
                    values[w] *= f[w];
                }
            }
        }
        values
    }
}

/// `f1*f2`, `f2*|f2|`, `f1^3`, `sgn(f1)`, `1`: components in order, the absolute value last of its component.
impl fmt::Display for Monomial {
    fn fmt(&self, text: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut times = "";
        for (j, power) in self.powers.into_iter().enumerate() {
            let is_signed = self.sign_of == Some(j);
            if is_signed && power == 0 {
                write!(text, "{times}sgn(f{})", j + 1)?;
                times = "*";
                continue;
            }
            let absolute = u8::from(is_signed);
            match power - absolute {
                0 => {}
                1 => write!(text, "{times}f{}", j + 1)?,
                power => write!(text, "{times}f{}^{power}", j + 1)?,
            }
            if power > absolute {
                times = "*";
            }
            if absolute == 1 {
                write!(text, "{times}|f{}|", j + 1)?;
                times = "*";
            }
        }
        if times.is_empty() { text.write_str("1") } else { Ok(()) }
    }
}

/// `x^n` by squaring; the powers that error models are made of without a loop.
#[inline]
fn power(x: f64, n: u8) -> f64 {
    match n {
        0 => 1.0,
        1 => x,
        2 => x * x,
        3 => x * x * x,
        _ => power_by_squaring(x, n),
    }
}

fn power_by_squaring(mut x: f64, mut n: u8) -> f64 {
    let mut power = 1.0;
    while n > 0 {
        if n % 2 == 1 {
            power *= x;
        }
        x *= x;
        n /= 2;
    }
    power
}
