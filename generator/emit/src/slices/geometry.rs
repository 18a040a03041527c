//! Positions, velocities, accelerations and partial velocities of points, and orientations of frames, for the
//! trait `Mechanism`.

use proc_macro2::{Literal, TokenStream};
use quote::{format_ident, quote};

use super::Written;
use crate::Emitter;
use hodograph_model::rust_names::snake_case;
use hodograph_program::program::{PointQuantity, Quantity};

impl Emitter<'_> {
    pub(super) fn geometry_by_slices(&self) -> TokenStream {
        let krate = self.krate;
        let m = self.mechanism;
        let point = |quantity: PointQuantity, method: &str, at_origin: TokenStream, what: &'static str| {
            let arms = m.points.iter().enumerate().map(|(index, point)| {
                let number = Quantity::Point(index as u32, quantity);
                let has = self.program.output(number).is_some_and(|output| !output.values.is_empty());
                let own = format_ident!("{method}_{}", snake_case(&point.name));
                let body = match (has, quantity) {
                    _ if index == 0 => quote!(DESCRIPTION.check(state)?; #at_origin),
                    (false, _) => self.undefined(what),
                    (true, PointQuantity::Jacobian) => {
                        let to = Written { method: own, slice: format_ident!("jacobian"), what };
                        self.written(number, &to)
                    }
                    (true, _) => {
                        let (unpack, call) = self.own(&own, &[number]);
                        quote!(#unpack #call)
                    }
                };
                (index, body)
            });
            self.by_number("point", "Point", arms.collect())
        };
        let zero = quote!(::core::result::Result::Ok(#krate::nalgebra::Vector3::zeros()));
        let given = self.given_accelerations();
        let acceleration =
            point(PointQuantity::Acceleration, "acceleration", zero.clone(), "acceleration of this point");
        let position = point(PointQuantity::Position, "position", zero.clone(), "position of this point");
        let velocity = point(PointQuantity::Velocity, "velocity", zero, "velocity of this point");
        let size = Literal::usize_unsuffixed(3 * self.speeds.len());
        let still = quote! {
            #krate::generated::check_length(jacobian, #size, "the partial velocities")?;
            jacobian.fill(T::zero());
            ::core::result::Result::Ok(())
        };
        let jacobian = point(PointQuantity::Jacobian, "jacobian", still, "the partial velocities");
        let frames = m.frames.iter().enumerate().map(|(index, frame)| {
            let quantity = Quantity::Orientation(index as u32);
            let body = if index == 0 {
                quote! {
                    DESCRIPTION.check(state)?;
                    ::core::result::Result::Ok(#krate::nalgebra::Matrix3::identity())
                }
            } else if self.program.output(quantity).is_some() {
                let (unpack, call) =
                    self.own(&format_ident!("orientation_{}", snake_case(&frame.name)), &[quantity]);
                quote!(#unpack #call)
            } else {
                self.undefined("orientation of this frame")
            };
            (index, body)
        });
        let orientation = self.by_number("frame", "Frame", frames.collect());
        let (vector, matrix) = (quote!(#krate::nalgebra::Vector3<T>), quote!(#krate::nalgebra::Matrix3<T>));
        quote! {
            fn position(
                &self,
                point: usize,
                state: &#krate::State<'_, T>,
            ) -> ::core::result::Result<#vector, #krate::StateError> {
                #position
            }
            fn velocity(
                &self,
                point: usize,
                state: &#krate::State<'_, T>,
            ) -> ::core::result::Result<#vector, #krate::StateError> {
                #velocity
            }
            fn acceleration(
                &self,
                point: usize,
                state: &#krate::State<'_, T>,
                accelerations: &[T],
            ) -> ::core::result::Result<#vector, #krate::StateError> {
                #given
                #acceleration
            }
            fn jacobian(
                &self,
                point: usize,
                state: &#krate::State<'_, T>,
                jacobian: &mut [T],
            ) -> ::core::result::Result<(), #krate::StateError> {
                #jacobian
            }
            fn orientation(
                &self,
                frame: usize,
                state: &#krate::State<'_, T>,
            ) -> ::core::result::Result<#matrix, #krate::StateError> {
                #orientation
            }
        }
    }
}
