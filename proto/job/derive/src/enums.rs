//! Enums: words, tagged objects, objects with one field.

use proc_macro2::TokenStream;
use quote::{format_ident, quote};
use syn::{DataEnum, DeriveInput, Fields, Type, Variant};

use crate::attributes::{Container, FieldAttributes};
use crate::field::{Member, Members};

pub(crate) fn derive(
    input: &DeriveInput,
    container: &Container,
    data: &DataEnum,
) -> syn::Result<TokenStream> {
    if let Some(tag) = &container.tag {
        return derive_tagged(input, container, &tag.value(), data);
    }
    if container.untagged {
        return derive_untagged(input, container, data);
    }
    let (words, others): (Vec<_>, Vec<_>) = data
        .variants
        .iter()
        .partition(|variant| matches!(variant.fields, Fields::Unit));
    let words: Vec<_> = words.into_iter().map(variant_name).collect();
    let (mut fields, mut numbers) = (Vec::new(), Vec::new());
    for variant in others {
        let member = Member::new(
            format_ident!("{}", variant_name(variant)),
            value_type(variant)?,
            FieldAttributes::read(&variant.attrs)?,
        );
        if member.is_float() {
            let (name, position) = (&variant.ident, fields.len());
            numbers.push(
                quote!(Self::#name(number) => found(&Self::FIELDS[#position], crate::described::Floats::floats(number)),),
            );
        }
        fields.push(member.field());
    }
    let (name, type_name) = (&input.ident, container.type_name(&input.ident));
    let shape = shape(!words.is_empty(), !fields.is_empty());
    let words = (!words.is_empty()).then(|| {
        quote! {
            /// The names of the word variants.
            pub const WORDS: &'static [&'static str] = &[#(#words),*];
        }
    });
    let fields = (!fields.is_empty()).then(|| {
        quote! {
            /// The variants with a value, as the fields of a one-field object.
            pub const FIELDS: &'static [crate::schema::Field] = &[#(#fields),*];
        }
    });
    Ok(quote! {
        impl #name { #words #fields }

        impl crate::described::Described for #name {
            const SHAPE: crate::schema::Shape = #shape;
            const NAME: &'static str = #type_name;

            fn numbers(&self, found: &mut dyn FnMut(&'static crate::schema::Field, &[f64])) {
                match self { #(#numbers)* _ => {} }
                let _ = found;
            }
        }
    })
}

fn shape(has_words: bool, has_fields: bool) -> TokenStream {
    match (has_words, has_fields) {
        (true, false) => quote!(crate::schema::Shape::Text(crate::schema::Names::Fixed(
            Self::WORDS
        ))),
        (false, true) => quote!(crate::schema::Shape::OneOf(Self::FIELDS)),
        _ => quote! {
            crate::schema::Shape::Either(
                crate::schema::Names::Fixed(Self::WORDS),
                &crate::schema::Shape::OneOf(Self::FIELDS),
            )
        },
    }
}

fn derive_tagged(
    input: &DeriveInput,
    container: &Container,
    tag: &str,
    data: &DataEnum,
) -> syn::Result<TokenStream> {
    let presence = match &container.default {
        Some(word) => {
            let json = format!("\"{}\"", word.value());
            quote!(crate::schema::Presence::Default(#json))
        }
        None => quote!(crate::schema::Presence::Required),
    };
    let mut options = Vec::new();
    for variant in &data.variants {
        let name = variant_name(variant);
        let (fields, type_name) = match &variant.fields {
            Fields::Unnamed(_) => {
                let inside = value_type(variant)?;
                let type_name = quote!(<#inside as crate::described::Described>::NAME);
                (quote!(#inside::FIELDS), type_name)
            }
            fields => {
                let fields = Members::read(fields)?.fields();
                let type_name = format!("{}{}", variant.ident, input.ident);
                (quote!(&[#(#fields),*]), quote!(#type_name))
            }
        };
        options.push(quote!(crate::schema::Variant { name: #name, fields: #fields, type_name: #type_name }));
    }
    let (name, type_name) = (&input.ident, container.type_name(&input.ident));
    Ok(quote! {
        impl crate::described::Described for #name {
            const NAME: &'static str = #type_name;
            const SHAPE: crate::schema::Shape = crate::schema::Shape::Tagged {
                tag: #tag,
                presence: #presence,
                options: &[#(#options),*],
            };
        }
    })
}

/// An enum of words and one object.
fn derive_untagged(input: &DeriveInput, container: &Container, data: &DataEnum) -> syn::Result<TokenStream> {
    let mut types = data.variants.iter().map(value_type);
    let (Some(words), Some(object), None) = (types.next(), types.next(), types.next()) else {
        let message = "words and an object were expected";
        return Err(syn::Error::new_spanned(&input.ident, message));
    };
    let (words, object) = (words?, object?);
    let (name, type_name) = (&input.ident, container.type_name(&input.ident));
    Ok(quote! {
        impl crate::described::Described for #name {
            const NAME: &'static str = #type_name;
            const SHAPE: crate::schema::Shape = crate::schema::Shape::Either(
                crate::schema::Names::Fixed(#words::WORDS),
                &<#object as crate::described::Described>::SHAPE,
            );
        }
    })
}

/// The type of a variant's only value.
fn value_type(variant: &Variant) -> syn::Result<&Type> {
    let mut fields = variant.fields.iter();
    match (fields.next(), fields.next()) {
        (Some(field), None) => Ok(&field.ty),
        _ => Err(syn::Error::new_spanned(variant, "one value was expected")),
    }
}

/// `ZDepth` as written in JSON: `z_depth`.
fn variant_name(variant: &Variant) -> String {
    let mut name = String::new();
    for letter in variant.ident.to_string().chars() {
        if letter.is_uppercase() && !name.is_empty() {
            name.push('_');
        }
        name.extend(letter.to_lowercase());
    }
    name
}
