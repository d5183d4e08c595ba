//! The fields of a struct or variant.

use proc_macro2::TokenStream;
use quote::quote;
use syn::{Fields, GenericArgument, Ident, PathArguments, Type};

use crate::attributes::{FieldAttributes, Limits};

/// The fields of a description.
pub(crate) struct Members(Vec<Member>);

/// One field with its name, type and attributes.
pub(crate) struct Member {
    name: Ident,
    is_option: bool,
    /// The field's type without `Option`.
    ty: Type,
    attributes: FieldAttributes,
}

impl Members {
    pub(crate) fn read(fields: &Fields) -> syn::Result<Self> {
        let mut members = Vec::new();
        for field in fields {
            let attributes = FieldAttributes::read(&field.attrs)?;
            let Some(name) = field.ident.clone().filter(|_| !attributes.skipped) else {
                continue;
            };
            members.push(Member::new(name, &field.ty, attributes));
        }
        Ok(Self(members))
    }

    /// Generates one `Field` per member.
    pub(crate) fn fields(&self) -> Vec<TokenStream> {
        self.0.iter().map(Member::field).collect()
    }

    /// Generates statements that pass each numeric field to `found`.
    pub(crate) fn numbers(&self) -> Vec<TokenStream> {
        self.0
            .iter()
            .enumerate()
            .filter_map(|(position, member): (usize, &Member)| {
                let name = &member.name;
                member.is_float().then(
                || quote!(found(&Self::FIELDS[#position], crate::described::Floats::floats(&self.#name));),
            )
            })
            .collect()
    }
}

impl Member {
    pub(crate) fn new(name: Ident, ty: &Type, attributes: FieldAttributes) -> Self {
        let inside = generic(ty, "Option");
        Self {
            name,
            is_option: inside.is_some(),
            ty: inside.unwrap_or(ty).clone(),
            attributes,
        }
    }

    /// Whether the field holds one float or three.
    pub(crate) fn is_float(&self) -> bool {
        match &self.ty {
            Type::Array(array) => is_named(&array.elem, "f64"),
            ty => is_named(ty, "f64"),
        }
    }

    pub(crate) fn field(&self) -> TokenStream {
        let name = self.name.to_string();
        let shape = shape(&self.ty, &self.attributes);
        let presence = match &self.attributes.default {
            Some(json) => quote!(crate::schema::Presence::Default(#json)),
            None if self.is_option || self.attributes.optional => quote!(crate::schema::Presence::Optional),
            None => quote!(crate::schema::Presence::Required),
        };
        let laws = !self.attributes.fixed;
        let unit = match &self.attributes.unit {
            Some(unit) => quote!(Some(#unit)),
            None => quote!(None),
        };
        let (doc, rules) = (&self.attributes.doc, &self.attributes.rules);
        let type_name = type_name(&self.ty, &self.attributes);
        quote! {
            crate::schema::Field {
                name: #name,
                shape: #shape,
                presence: #presence,
                laws: #laws,
                unit: #unit,
                doc: #doc,
                rules: &[#(#rules),*],
                type_name: #type_name,
            }
        }
    }
}

const INTEGERS: [&str; 5] = ["u8", "u16", "u32", "u64", "usize"];

/// The name of the described type of a value or list element; `None` for plain values.
fn type_name(ty: &Type, attributes: &FieldAttributes) -> TokenStream {
    let element = generic(ty, "Vec").unwrap_or(ty);
    let plain = ["bool", "f64", "BTreeMap"].iter().chain(&INTEGERS);
    let is_plain = matches!(element, Type::Array(_)) || plain.into_iter().any(|name| is_named(element, name));
    if is_plain || attributes.names.is_some() {
        quote!(None)
    } else {
        quote!(Some(<#element as crate::described::Described>::NAME))
    }
}

/// Generates the shape of a value of this type.
fn shape(ty: &Type, attributes: &FieldAttributes) -> TokenStream {
    if let Some(element) = generic(ty, "Vec") {
        let element = shape(element, attributes);
        let max = attributes
            .max
            .as_ref()
            .map_or(quote!(usize::MAX), |max| quote!(#max));
        let distinct = attributes.distinct;
        return quote!(crate::schema::Shape::List { element: &#element, max: #max, distinct: #distinct });
    }
    if let Some(names) = &attributes.names {
        return quote!(crate::schema::Shape::Text(#names));
    }
    if is_named(ty, "BTreeMap") {
        return quote!(crate::schema::Shape::Labels);
    }
    if is_named(ty, "bool") {
        return quote!(crate::schema::Shape::Bool);
    }
    if is_named(ty, "f64") {
        let range = range(attributes.limits.as_ref());
        return quote!(crate::schema::Shape::Number(#range));
    }
    if let Type::Array(array) = ty {
        if !is_named(&array.elem, "f64") {
            return match &attributes.limits {
                Some(Limits::Within(low, high)) => {
                    quote!(crate::schema::Shape::Pair(#low as i128, #high as i128))
                }
                _ => quote!(compile_error!("two whole numbers need `within(a, b)`")),
            };
        }
        let range = range(attributes.limits.as_ref());
        return if attributes.vector {
            quote!(crate::schema::Shape::Vector(#range))
        } else {
            quote!(crate::schema::Shape::Rgb(#range))
        };
    }
    if INTEGERS.iter().any(|integer| is_named(ty, integer)) {
        return match &attributes.limits {
            Some(Limits::Within(low, high)) => {
                quote!(crate::schema::Shape::Integer(#low as i128, #high as i128))
            }
            _ => quote!(compile_error!("a whole number needs `within(a, b)`")),
        };
    }
    quote!(<#ty as crate::described::Described>::SHAPE)
}

fn range(limits: Option<&Limits>) -> TokenStream {
    match limits {
        Some(Limits::Within(low, high)) => quote!(crate::schema::Range::within(#low, #high)),
        Some(Limits::Above(low, high)) => quote!(crate::schema::Range::above(#low, #high)),
        Some(Limits::Finite) => quote!(crate::schema::Range::FINITE),
        None => quote!(compile_error!(
            "a number needs limits: `within`, `above` or `finite`"
        )),
    }
}

/// `T` of `wrapper<T>`.
fn generic<'t>(ty: &'t Type, wrapper: &str) -> Option<&'t Type> {
    let Type::Path(path) = ty else { return None };
    let last = path.path.segments.last().filter(|last| last.ident == wrapper)?;
    let PathArguments::AngleBracketed(arguments) = &last.arguments else {
        return None;
    };
    match arguments.args.first()? {
        GenericArgument::Type(inside) => Some(inside),
        _ => None,
    }
}

fn is_named(ty: &Type, name: &str) -> bool {
    matches!(ty, Type::Path(path) if path.path.segments.last().is_some_and(|last| last.ident == name))
}
