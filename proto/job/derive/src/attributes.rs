//! Parsing of the derive's attributes.

use proc_macro2::{Delimiter, TokenStream, TokenTree};
use quote::quote;
use syn::meta::ParseNestedMeta;
use syn::punctuated::Punctuated;
use syn::{Attribute, Expr, Ident, LitInt, LitStr, Token, parenthesized};

/// Attributes of a type.
#[derive(Default)]
pub(crate) struct Container {
    /// The only field of an object that may be written as a string.
    pub(crate) short: Option<LitStr>,
    /// Name of the type where its module is not visible.
    pub(crate) name: Option<LitStr>,
    /// Tag of an object without one.
    pub(crate) default: Option<LitStr>,
    /// The field that selects the variant, from serde.
    pub(crate) tag: Option<LitStr>,
    /// Whether the type is a word or an object, from serde.
    pub(crate) untagged: bool,
}

impl Container {
    pub(crate) fn read(attributes: &[Attribute]) -> syn::Result<Self> {
        let mut container = Self::default();
        for attribute in attributes.iter().filter(|it| it.path().is_ident("described")) {
            attribute.parse_nested_meta(|meta| {
                let value = Some(meta.value()?.parse()?);
                match () {
                    () if meta.path.is_ident("short") => container.short = value,
                    () if meta.path.is_ident("default") => container.default = value,
                    () if meta.path.is_ident("name") => container.name = value,
                    () => return Err(meta.error("`short`, `default` or `name` was expected")),
                }
                Ok(())
            })?;
        }
        for attribute in attributes.iter().filter(|it| it.path().is_ident("serde")) {
            attribute.parse_nested_meta(|meta| {
                let value: Option<LitStr> = match meta.value() {
                    Ok(value) => Some(value.parse()?),
                    Err(_) => None,
                };
                container.untagged |= meta.path.is_ident("untagged");
                if meta.path.is_ident("tag") {
                    container.tag = value;
                }
                Ok(())
            })?;
        }
        Ok(container)
    }

    /// The name of the type outside its module.
    pub(crate) fn type_name(&self, ident: &Ident) -> String {
        self.name
            .as_ref()
            .map_or_else(|| ident.to_string(), LitStr::value)
    }
}

/// Attributes of a field, or of a variant with a value.
#[derive(Default)]
pub(crate) struct FieldAttributes {
    /// The doc comment as one line.
    pub(crate) doc: String,
    /// Excluded from the description.
    pub(crate) skipped: bool,
    pub(crate) limits: Option<Limits>,
    pub(crate) default: Option<String>,
    pub(crate) optional: bool,
    pub(crate) unit: Option<LitStr>,
    pub(crate) fixed: bool,
    pub(crate) vector: bool,
    /// Allowed strings, as `Names`.
    pub(crate) names: Option<TokenStream>,
    pub(crate) max: Option<LitInt>,
    pub(crate) distinct: bool,
    /// Constraints across fields, each a `Rule`.
    pub(crate) rules: Vec<TokenStream>,
}

pub(crate) enum Limits {
    Within(Expr, Expr),
    Above(Expr, Expr),
    Finite,
}

impl FieldAttributes {
    pub(crate) fn read(attributes: &[Attribute]) -> syn::Result<Self> {
        let mut field = Self {
            doc: read_doc(attributes),
            ..Self::default()
        };
        for attribute in attributes {
            if attribute.path().is_ident("field") {
                attribute.parse_nested_meta(|meta| field.parse(&meta))?;
            } else if attribute.path().is_ident("serde") {
                attribute.parse_nested_meta(|meta| {
                    field.skipped |= meta.path.is_ident("skip");
                    if let Ok(value) = meta.value() {
                        value.parse::<Expr>()?;
                    }
                    Ok(())
                })?;
            }
        }
        Ok(field)
    }

    fn parse(&mut self, meta: &ParseNestedMeta<'_>) -> syn::Result<()> {
        let word = meta.path.require_ident()?.to_string();
        match word.as_str() {
            "within" => {
                let (low, high) = parse_pair(meta)?;
                self.limits = Some(Limits::Within(low, high));
            }
            "above" => {
                let (low, high) = parse_pair(meta)?;
                self.limits = Some(Limits::Above(low, high));
            }
            "finite" => self.limits = Some(Limits::Finite),
            "default" => self.default = Some(token_to_json(meta.value()?.parse()?)),
            "optional" => self.optional = true,
            "unit" => self.unit = Some(meta.value()?.parse()?),
            "fixed" => self.fixed = true,
            "vector" => self.vector = true,
            "names" => {
                let name: Ident = meta.value()?.parse()?;
                self.names = Some(quote!(crate::schema::Names::#name));
            }
            "words" => {
                let list: Expr = meta.value()?.parse()?;
                self.names = Some(quote!(crate::schema::Names::Fixed(&#list)));
            }
            "max" => self.max = Some(meta.value()?.parse()?),
            "distinct" => self.distinct = true,
            "nonzero" => self.rules.push(quote!(crate::schema::Rule::NonZero)),
            "odd" => self.rules.push(quote!(crate::schema::Rule::Odd)),
            "untraced" => {
                let reason: LitStr = meta.value()?.parse()?;
                self.rules.push(quote!(crate::schema::Rule::Untraced(#reason)));
            }
            "needs" | "needs_always" | "excludes" | "below" | "at_most" | "differs" => {
                self.rules.push(parse_rule(&word, meta)?)
            }
            _ => return Err(meta.error("no attribute of a field")),
        }
        Ok(())
    }
}

/// Parses a rule with field names: `needs("range", "z_depth")`.
fn parse_rule(word: &str, meta: &ParseNestedMeta<'_>) -> syn::Result<TokenStream> {
    let content;
    parenthesized!(content in meta.input);
    let paths: Vec<_> = Punctuated::<LitStr, Token![,]>::parse_terminated(&content)?
        .into_iter()
        .collect();
    Ok(match (word, paths.as_slice()) {
        ("needs", [_, ..]) => quote!(crate::schema::Rule::Needs(&[#(#paths),*])),
        ("excludes", [_, ..]) => quote!(crate::schema::Rule::Excludes(&[#(#paths),*])),
        ("needs_always", [path]) => quote!(crate::schema::Rule::NeedsAlways(#path)),
        ("below", [path]) => quote!(crate::schema::Rule::Below(#path)),
        ("at_most", [path]) => quote!(crate::schema::Rule::AtMost(#path)),
        ("differs", [path]) => quote!(crate::schema::Rule::Differs(#path)),
        _ => return Err(meta.error("the paths of other fields were expected")),
    })
}

fn parse_pair(meta: &ParseNestedMeta<'_>) -> syn::Result<(Expr, Expr)> {
    let content;
    parenthesized!(content in meta.input);
    let ends = Punctuated::<Expr, Token![,]>::parse_terminated(&content)?;
    let mut ends = ends.into_iter();
    match (ends.next(), ends.next(), ends.next()) {
        (Some(low), Some(high), None) => Ok((low, high)),
        _ => Err(meta.error("two ends were expected")),
    }
}

/// The tokens of a JSON value as JSON text.
fn token_to_json(value: TokenTree) -> String {
    let TokenTree::Group(group) = value else {
        return value.to_string();
    };
    let inner: String = group
        .stream()
        .into_iter()
        .map(|token| match &token {
            TokenTree::Punct(sign) if matches!(sign.as_char(), ',' | ':') => format!("{sign} "),
            _ => token_to_json(token),
        })
        .collect();
    match group.delimiter() {
        Delimiter::Brace => format!("{{{inner}}}"),
        _ => format!("[{inner}]"),
    }
}

fn read_doc(attributes: &[Attribute]) -> String {
    let lines = attributes.iter().filter_map(|attribute| {
        let value = &attribute.meta.require_name_value().ok()?.value;
        match value {
            Expr::Lit(syn::ExprLit {
                lit: syn::Lit::Str(text),
                ..
            }) if attribute.path().is_ident("doc") => Some(text.value().trim().to_owned()),
            _ => None,
        }
    });
    lines.collect::<Vec<_>>().join(" ")
}
