//! `#[derive(Described)]` generates the schema of a description type.
//!
//! A field is declared once: name and type, doc comment, and `#[field(…)]` for constraints that the type cannot
//! express:
//!
//! ```text
//! /// Marine snow.
//! #[derive(Described)]
//! pub struct Snow {
//!     /// particles per cubic meter; at most 400 000 in view
//!     #[field(within(0.0, 1e6), unit = "1/m³")]
//!     pub density_per_m3: f64,
//!     /// median radius
//!     #[field(within(1e-5, 0.02), default = 0.001, unit = "m")]
//!     pub radius_m: f64,
//! }
//! ```
//!
//! | attribute | meaning |
//! |---|---|
//! | `within(a, b)`, `above(a, b)`, `finite` | limits of each number; `above` excludes a |
//! | `default = JSON` | value of an absent field; without it the field is required, or optional if it is an `Option` |
//! | `optional` | may be absent although it is not an `Option`; filled in before the frame is read |
//! | `unit = "m"` | unit of its numbers |
//! | `fixed` | cannot be a distribution |
//! | `vector` | its three numbers are x, y, z instead of R, G, B |
//! | `names = Style`, `words = LIST` | allowed strings |
//! | `max = 64`, `distinct` | maximum length of a list, and whether its elements must differ |
//! | `needs("a", "b")` | requires one of these fields |
//! | `needs_always("a")` | requires this field in every frame |
//! | `excludes("a", "b")` | rejects these fields |
//! | `below("a")`, `at_most("a")`, `differs("a")` | comparison with another field |
//! | `nonzero` | its three numbers are not all 0 |
//! | `odd` | the number is odd |
//! | `untraced = "why"` | the Monte Carlo truth does not model it |
//!
//! A name without a dot is a field of the same object. A path with dots starts at the description, as in
//! `water.optics`, or names a word of a list, as in `artifacts.truth`.
//!
//! An enum of words is written as a name in snake case. An enum with `#[serde(tag = "kind")]` is an object whose
//! field `kind` names the variant. In any other enum each variant with a value is an object of one field, and the
//! others are words. `#[described(short = "preset")]` accepts a string for an object with that one field.
//! `#[described(default = "png")]` is the tag of an object without one. `#[described(name = "FidelityVariant")]`
//! renames a type for use outside its module.

mod attributes;
mod enums;
mod field;

use proc_macro2::TokenStream;
use quote::quote;
use syn::{Data, DeriveInput, parse_macro_input};

use attributes::Container;
use field::Members;

/// Derives `Described`; see the documentation of the crate.
#[proc_macro_derive(Described, attributes(field, described, serde))]
pub fn described(input: proc_macro::TokenStream) -> proc_macro::TokenStream {
    let input = parse_macro_input!(input as DeriveInput);
    derive(&input)
        .unwrap_or_else(|error| error.to_compile_error())
        .into()
}

fn derive(input: &DeriveInput) -> syn::Result<TokenStream> {
    let container = Container::read(&input.attrs)?;
    match &input.data {
        Data::Struct(data) => derive_struct(input, &container, data),
        Data::Enum(data) => enums::derive(input, &container, data),
        Data::Union(_) => Err(syn::Error::new_spanned(
            &input.ident,
            "a union cannot be described",
        )),
    }
}

fn derive_struct(
    input: &DeriveInput,
    container: &Container,
    data: &syn::DataStruct,
) -> syn::Result<TokenStream> {
    let name = &input.ident;
    let members = Members::read(&data.fields)?;
    let (fields, numbers) = (members.fields(), members.numbers());
    let type_name = container.type_name(name);
    let shape = match &container.short {
        Some(field) => quote!(crate::schema::Shape::Short(#field, Self::FIELDS)),
        None => quote!(crate::schema::Shape::Object(Self::FIELDS)),
    };
    Ok(quote! {
        impl #name {
            /// The fields of the description.
            pub const FIELDS: &'static [crate::schema::Field] = &[#(#fields),*];
        }

        impl crate::described::Described for #name {
            const SHAPE: crate::schema::Shape = #shape;
            const NAME: &'static str = #type_name;

            fn numbers(&self, found: &mut dyn FnMut(&'static crate::schema::Field, &[f64])) {
                #(#numbers)*
                let _ = found;
            }
        }
    })
}
