//! Emits the methods for the derivatives of a collision and its saltation matrix.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::Emitter;
use super::interface::{Argument, Failure, Field, Group, Method, Signature, Struct, Type};
use super::routine::Routine;
use super::values::local;
use crate::identifiers::ident;
use hodograph_program::program::{ContactQuantity, Quantity};

/// The quantities of a contact that the derivative with respect to the speeds needs.
const NEEDED: [ContactQuantity; 4] = [
    ContactQuantity::Velocity,
    ContactQuantity::PartialVelocities,
    ContactQuantity::Reduced,
    ContactQuantity::Response,
];

impl Emitter<'_> {
    /// Number of independent speeds.
    fn independent_speeds(&self) -> usize {
        self.speeds.len()
    }

    /// The type of differentiated collisions, if there is a contact with collisions.
    pub fn derivative_structure(&self) -> Option<Struct> {
        (0..self.mechanism.contacts.len()).find(|&contact| self.collides(contact))?;
        let p = self.independent_speeds();
        let independent = self.mechanism.speeds.iter().filter(|speed| !speed.dependent);
        let names: Vec<_> = independent.map(|speed| format!("`{}`", speed.name)).collect();
        let docs = format!(
            "The derivative of a collision at one configuration. Rows and columns of speeds are {}, in this order.",
            names.join(", ")
        );
        let by = |name: &str, what: &str| {
            let docs = format!("derivative of the speeds after with respect to the coefficient of {what}");
            Field::new(name, Type::Vector(p), &docs)
        };
        let fields = vec![
            Field::new(
                "speeds",
                Type::of_shape(p, p),
                "derivative of the speeds after the collision with respect to those before: 1 + M^-1 V^T (dI/dv) V",
            ),
            by("by_friction", "friction"),
            by("by_restitution", "restitution"),
            Field::new(
                "outcome",
                Type::ImpactDerivative,
                "derivatives of impulse and velocity of separation with respect to velocity of approach, reduced matrix, mu and e, along the contact basis \
                 (normal, first, second); if there is no derivative `outcome.non_smoothness` says why",
            ),
        ];
        Some(Struct::of_results("CollisionDerivative", &docs, fields))
    }

    /// `contact_tangent_..`, `collide_.._derivative` and `saltation_..` of a contact.
    pub fn derivatives(&self, contact: usize) -> Group {
        let routines = [self.contact_tangent(contact), self.contact_derivatives(contact)];
        let routines = routines.iter().flatten().map(|routine| self.routine(routine));
        let whole = [self.collide_derivative(contact), self.saltation(contact)];
        Group { methods: routines.chain(whole.into_iter().flatten()).collect(), ..Group::default() }
    }

    /// The routine of the derivative of a contact along a direction.
    pub fn contact_tangent(&self, contact: usize) -> Option<Routine> {
        self.contact_output(contact, ContactQuantity::Tangent).map(|output| {
            let (answer, value) = self.shaped(output);
            let docs = format!(
                "Directional derivative of velocity (3 numbers), reduced matrix (6: nn, nt, ns, tt, ts, ss) and response M^-1 V^T (by rows){} at {}, along the contact basis.",
                if self.contact_output(contact, ContactQuantity::Gap).is_some() { " and gap" } else { "" },
                self.contact_words(contact)
            );
            let name = self.contact_method("contact_tangent", contact);
            Routine { name, docs, quantities: vec![output.quantity], answer, value }
        })
    }

    fn collide_derivative(&self, contact: usize) -> Option<Method> {
        let krate = self.krate;
        let outputs: Vec<_> =
            NEEDED.iter().filter_map(|&quantity| self.contact_output(contact, quantity)).collect();
        let [velocity, partial, reduced, response] = outputs[..] else { return None };
        let quantities: Vec<Quantity> = outputs.iter().map(|output| output.quantity).collect();
        let velocity = velocity.values.iter().map(|&value| local(value));
        let (_, partial) = self.matrix(partial);
        let reduced = self.reduced(reduced);
        let (_, response) = self.matrix(response);
        let docs = format!(
            "Solves the collision at {} and differentiates its outcome. Where the outcome has no derivative, `outcome.non_smoothness` says why.",
            self.contact_words(contact)
        );
        let mut arguments = self.arguments(&quantities);
        arguments.speeds = true;
        let compute = self.compute(&quantities);
        let body = quote! {
            #compute
            let velocity = #krate::nalgebra::Vector3::new(#(#velocity),*);
            let outcome = #krate::derivative(&#reduced, &velocity, surface)?;
            let response = #response;
            ::core::result::Result::Ok(CollisionDerivative {
                speeds: #krate::speed_derivative(&outcome, &#partial, &response),
                by_friction: response * outcome.by_friction().0,
                by_restitution: response * outcome.by_restitution().0,
                outcome,
            })
        };
        let mut arguments = self.declared(arguments);
        arguments.push(Argument { name: "surface", of: Type::Surface });
        let name = format!("{}_derivative", self.contact_method("collide", contact));
        let answer = Type::of_struct("CollisionDerivative");
        let signature =
            Signature { name, docs, arguments, answer, failure: Failure::Collision, in_place: None };
        Some(Method { signature, attributes: TokenStream::new(), body })
    }

    /// The saltation matrix, if the contact has a gap and derivatives with respect to the coordinates.
    fn saltation(&self, contact: usize) -> Option<Method> {
        let krate = self.krate;
        let tangent = self.contact_output(contact, ContactQuantity::Tangent)?;
        self.contact_output(contact, ContactQuantity::Gap)?;
        let response = self.contact_output(contact, ContactQuantity::Response)?;
        self.program.output(Quantity::Accelerations)?;
        self.program.output(Quantity::CoordinateRates)?;
        let coordinates: Vec<usize> = (0..self.mechanism.coordinates.len())
            .filter(|&i| !self.mechanism.coordinates[i].dependent)
            .collect();
        let p = self.independent_speeds();
        let count = coordinates.len() + p;
        let directions = Literal::usize_unsuffixed(count + self.mechanism.inputs.len());
        let [n, c, p] = [count, coordinates.len(), p].map(Literal::usize_unsuffixed);
        let indices = coordinates.iter().map(|&index| Literal::usize_unsuffixed(index));

        let collision = [ContactQuantity::Velocity, ContactQuantity::Reduced, ContactQuantity::Response]
            .map(|quantity| Quantity::Contact(contact as u32, quantity));
        let [of_response, of_rates, of_accelerations, of_tangent] = [
            Quantity::Contact(contact as u32, ContactQuantity::Response),
            Quantity::CoordinateRates,
            Quantity::Accelerations,
            tangent.quantity,
        ]
        .map(|quantity| self.arguments(&[quantity]));
        let mut of_collision = self.arguments(&collision);
        of_collision.speeds = true;
        let mut all = of_collision;
        for arguments in [of_response, of_rates, of_accelerations, of_tangent] {
            all.coordinates |= arguments.coordinates;
            all.inputs |= arguments.inputs;
        }
        let [to_collision, to_rates, to_accelerations, to_tangent] =
            [of_collision, of_rates, of_accelerations, of_tangent].map(|mut arguments| {
                arguments.tangent = false;
                self.passed(arguments)
            });
        let after = |arguments: super::routine::Arguments| {
            let mut arguments = arguments;
            let speeds = arguments.speeds;
            arguments.speeds = false;
            let time = arguments.time.then(|| quote!(time,));
            let q = arguments.coordinates.then(|| quote!(q,));
            let u = speeds.then(|| quote!(&after_speeds,));
            let inputs = arguments.inputs.then(|| quote!(inputs,));
            quote!(#time #q #u #inputs)
        };
        let [rates_after, accelerations_after] = [of_rates, of_accelerations].map(after);
        let body = self.compute(&[response.quantity]);
        let (_, response) = self.matrix(response);
        let tangent_routine = ident(&self.contact_method("contact_tangent", contact));
        let derivative_routine = ident(&format!("{}_derivative", self.contact_method("collide", contact)));
        let collide_routine = ident(&self.contact_method("collide", contact));
        let states: Vec<_> = self
            .mechanism
            .coordinates
            .iter()
            .chain(&self.mechanism.speeds)
            .filter(|q| !q.dependent)
            .map(|q| format!("`{}`", q.name))
            .collect();
        let docs = format!(
            "The saltation matrix of the collision at {}: to first order it maps the deviation of a neighbouring trajectory before the collision to that \
             after it, at the same time. The states are {}, in this order. Where there is no derivative, `non_smoothness` says why.",
            self.contact_words(contact),
            states.join(", ")
        );
        let changes = match self.contact_derivatives(contact) {
            Some(routine) => {
                let routine = ident(&routine.name);
                quote! {
                    let changes = self.#routine(#to_tangent)?;
                    let gaps = changes.gap_by_coordinates.unwrap_or(#krate::nalgebra::SVector::zeros());
                    for column in 0..#c {
                        let gap = #krate::generated::by_coordinates(
                            &mut reset,
                            column,
                            outcome,
                            &response,
                            (&changes.velocity_by_coordinates, &changes.reduced_by_coordinates, &changes.response_by_coordinates, &gaps),
                        );
                        if let ::core::option::Option::Some(entry) = gradient.as_mut_slice().get_mut(column) {
                            *entry = gap;
                        }
                    }
                }
            }
            None => quote! {
                for column in 0..#c {
                    let mut direction = [T::zero(); #directions];
                    if let ::core::option::Option::Some(entry) = direction.get_mut(column) {
                        *entry = T::one();
                    }
                    let change = self.#tangent_routine(#to_tangent &direction)?;
                    let gap =
                        #krate::generated::by_coordinate(&mut reset, column, outcome, &response, change.as_slice());
                    if let ::core::option::Option::Some(entry) = gradient.as_mut_slice().get_mut(column) {
                        *entry = gap;
                    }
                }
            },
        };
        let body = quote! {
                let hit = self.#collide_routine(#to_collision surface)?;
                let derivative = self.#derivative_routine(#to_collision surface)?;
                let outcome = &derivative.outcome;
                let after_speeds = hit.speeds;
                let response = { #body #response };
                let rates: [T; _] = self.coordinate_rates(#to_rates)?.into();
                let later: [T; _] = self.coordinate_rates(#rates_after)?.into();
                let forces: [T; #p] = self.accelerations(#to_accelerations)?.into();
                let then: [T; #p] = self.accelerations(#accelerations_after)?.into();
                let independent: [usize; #c] = [#(#indices),*];
                let before = #krate::generated::state::<T, _, #c, #p, #n>(&rates, &independent, &forces);
                let after = #krate::generated::state::<T, _, #c, #p, #n>(&later, &independent, &then);
                let mut reset = #krate::generated::reset::<T, #p, #n>(&derivative.speeds);
                let mut gradient = #krate::nalgebra::SVector::<T, #n>::zeros();
                #changes
                #krate::generated::salted(&reset, &before, &after, &gradient, outcome)
        };
        let mut arguments = self.declared(all);
        arguments.push(Argument { name: "surface", of: Type::Surface });
        let answer = Type::Saltation(count);
        let name = self.contact_method("saltation", contact);
        let signature =
            Signature { name, docs, arguments, answer, failure: Failure::Collision, in_place: None };
        Some(Method { signature, attributes: TokenStream::new(), body })
    }
}
