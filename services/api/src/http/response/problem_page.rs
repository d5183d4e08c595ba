//! Pages that describe the types of problems.

use crate::http::extract::Path;
use crate::http::problem::{Problem, Slug};

/// `GET /problems/{slug}`: the meaning of a problem type.
pub(crate) async fn describe(Path(name): Path<String>) -> Result<String, Problem> {
    let slug = Slug::ALL.iter().find(|slug| slug.name() == name);
    let slug = slug.ok_or_else(|| Problem::not_found(format!("no problem type `{name}`")))?;
    Ok(format!(
        "{} ({})\n\n{}\n",
        slug.title(),
        slug.status(),
        slug.meaning()
    ))
}
