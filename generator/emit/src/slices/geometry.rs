//! Positions, velocities, accelerations and partial velocities of points, and orientations of frames, for the
//! trait `Mechanism`.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use crate::Emitter;
use hodograph_program::program::{PointQuantity, Quantity};

impl Emitter<'_> {
    pub(super) fn geometry_by_slices(&self) -> TokenStream {
        let krate = self.krate;
        let m = self.mechanism;
        let point = |quantity: PointQuantity, at_origin: TokenStream, what: &'static str| {
            let arms = (0..m.points.len()).map(|index| {
                let number = Quantity::Point(index as u32, quantity);
                let has = self.program.output(number).is_some_and(|output| !output.values.is_empty());
                let body = match (has, quantity) {
                    _ if index == 0 => quote!(DESCRIPTION.check(state)?; #at_origin),
                    (false, _) => self.undefined(what),
                    (true, PointQuantity::Jacobian) => self.written(number),
                    (true, _) => {
                        let (unpack, call) = self.own(number);
                        quote!(#unpack #call)
                    }
                };
                (index, body)
            });
            self.by_number("point", "Point", arms.collect())
        };
        let zero = quote!(::core::result::Result::Ok(#krate::nalgebra::Vector3::zeros()));
        let given = self.given_accelerations();
        let acceleration = point(PointQuantity::Acceleration, zero.clone(), "acceleration of this point");
        let position = point(PointQuantity::Position, zero.clone(), "position of this point");
        let velocity = point(PointQuantity::Velocity, zero, "velocity of this point");
        let size = Literal::usize_unsuffixed(3 * self.speeds.len());
        let still = quote! {
            #krate::generated::check_length(jacobian, #size, "the partial velocities")?;
            jacobian.fill(T::zero());
            ::core::result::Result::Ok(())
        };
        let jacobian = point(PointQuantity::Jacobian, still, "the partial velocities");
        let frames = (0..m.frames.len()).map(|index| {
            let quantity = Quantity::Orientation(index as u32);
            let body = if index == 0 {
                quote! {
                    DESCRIPTION.check(state)?;
                    ::core::result::Result::Ok(#krate::nalgebra::Matrix3::identity())
                }
            } else if self.program.output(quantity).is_some() {
                let (unpack, call) = self.own(quantity);
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
