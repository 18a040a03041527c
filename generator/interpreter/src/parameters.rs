//! Checks parameters, with the same checks in the same order as the constructor of a generated module.

use hodograph::ParameterError;
use hodograph::generated::{abs, check_inertia, check_mass, check_size, exp, log, power, recip, sqrt};
use hodograph_model::arithmetic::Function;
use hodograph_model::model::mechanism::{DefinitionValue, Mechanism, Scalar, Variable};
use hodograph_program::interpret::Constants;
use hodograph_program::program::Program;

use crate::intern::intern;

/// Expressions nested deeper than this are not checked.
const DEPTH: usize = 64;

/// Checks parameters (in file order, `fixed` ones too) and computes what depends on them alone.
///
/// # Errors
///
/// As `new` of a generated module.
pub fn constants(
    model: &Mechanism,
    program: &Program,
    parameters: &[f64],
) -> Result<Constants, ParameterError> {
    check(model, parameters)?;
    let constants = Constants::new(program, parameters);
    let not_finite = || ParameterError::from(hodograph::StateError::NotFinite);
    if let Some((message, finite)) = constants.failure(program) {
        let singular = ParameterError::Singular { what: intern(message) };
        return Err(if finite { singular } else { not_finite() });
    }
    if constants.finite(program) { Ok(constants) } else { Err(not_finite()) }
}

/// Checks what the model says of its bodies and shapes with these parameters.
///
/// # Errors
///
/// As `new` of a generated module.
pub fn check(model: &Mechanism, parameters: &[f64]) -> Result<(), ParameterError> {
    let run_time = model.parameters.iter().zip(parameters).filter(|(parameter, _)| !parameter.fixed);
    for (parameter, value) in run_time {
        if !value.is_finite() {
            return Err(ParameterError::NotFinite { name: intern(&parameter.name) });
        }
    }
    for body in &model.bodies {
        let name = intern(&body.name);
        if let Some(mass) = scalar(model, parameters, &body.mass, DEPTH) {
            check_mass(mass, name)?;
        }
        let components = body.inertia.as_ref().map(|inertia| {
            inertia.components.each_ref().map(|component| scalar(model, parameters, component, DEPTH))
        });
        if let Some([Some(xx), Some(yy), Some(zz), Some(xy), Some(yz), Some(zx)]) = components {
            check_inertia([xx, yy, zz, xy, yz, zx], name)?;
        }
    }
    for shape in &model.shapes {
        for dimension in shape.dimensions() {
            if let Some(size) = scalar(model, parameters, &dimension.value, DEPTH) {
                check_size(size, intern(&shape.name), dimension.name)?;
            }
        }
    }
    Ok(())
}

/// All parameters from those that are not `fixed`.
///
/// # Errors
///
/// [`ParameterError::Length`].
pub fn all(model: &Mechanism, parameters: &[f64]) -> Result<Vec<f64>, ParameterError> {
    let expected = model.parameters.iter().filter(|parameter| !parameter.fixed).count();
    if parameters.len() != expected {
        return Err(ParameterError::Length { expected, found: parameters.len() });
    }
    let mut given = parameters.iter().copied();
    let mut next = |parameter: &Variable| match parameter.fixed {
        true => parameter.value.unwrap_or(0.0),
        false => given.next().unwrap_or(f64::NAN),
    };
    Ok(model.parameters.iter().map(&mut next).collect())
}

/// Those that are not `fixed`, of all parameters.
pub fn run_time(model: &Mechanism, all: &[f64]) -> Vec<f64> {
    let all = model.parameters.iter().zip(all);
    all.filter(|(parameter, _)| !parameter.fixed).map(|(_, &value)| value).collect()
}

/// An expression of parameters alone; `None` for any other.
fn scalar(model: &Mechanism, parameters: &[f64], expression: &Scalar, depth: usize) -> Option<f64> {
    let depth = depth.checked_sub(1)?;
    let of = |expression: &Scalar| scalar(model, parameters, expression, depth);
    Some(match expression {
        Scalar::Number(value) => value.to_f64(),
        Scalar::Pi => std::f64::consts::PI,
        Scalar::Parameter(id) => {
            if model.parameters.get(id.0)?.fixed {
                return None;
            }
            *parameters.get(id.0)?
        }
        Scalar::Definition(id) => match &model.definitions.get(id.0)?.value {
            DefinitionValue::Scalar(scalar) => of(scalar)?,
            DefinitionValue::Vector(_) => return None,
        },
        Scalar::Neg(a) => -of(a)?,
        Scalar::Add(terms) => {
            let mut terms = terms.iter().map(of);
            let first = terms.next()??;
            terms.try_fold(first, |sum, term| Some(sum + term?))?
        }
        Scalar::Mul(factors) => {
            let mut factors = factors.iter().map(of);
            let first = factors.next()??;
            factors.try_fold(first, |product, factor| Some(product * factor?))?
        }
        Scalar::Div(a, b, _) => of(a)? / of(b)?,
        Scalar::Pow(base, exponent) => {
            let base = of(base)?;
            match &**exponent {
                Scalar::Number(n) if n.to_integer().is_some_and(|n| i32::try_from(n).is_ok()) => {
                    let n = i32::try_from(n.to_integer()?).ok()?;
                    let power = power(base, n.abs());
                    if n < 0 { recip(power) } else { power }
                }
                exponent => exp(log(base) * of(exponent)?),
            }
        }
        Scalar::Call(Function::Sqrt, arguments) => sqrt(of(arguments.first()?)?),
        Scalar::Call(Function::Abs, arguments) => abs(of(arguments.first()?)?),
        _ => return None,
    })
}
