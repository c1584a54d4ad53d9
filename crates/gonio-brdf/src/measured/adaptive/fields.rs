//! Adaptive tables as fields of a `tensor_file`.

use super::tables::{Nodes, Tables, check_directions, check_size};
use crate::measured::file::Fault;
use crate::measured::input::Input;
use crate::measured::tensor_file::{Dtype, Field, TensorFile, TensorWriter, dimensions_of};

/// Fields whose names begin with `prefix`.
pub(in super::super) struct Fields<'a, 'b> {
    pub input: &'a Input<'b>,
    pub file: &'a TensorFile<'b>,
    pub prefix: &'a str,
}

impl Fields<'_, '_> {
    /// Everything but the values. Numbers stay where they are in a file that is mapped.
    pub fn tables(&self) -> Result<Tables, Fault> {
        let theta_i = self.list("theta_i")?;
        let phi_i = self.list("phi_i")?;
        check_directions(&phi_i, &theta_i)?;
        let slices = [phi_i.len(), theta_i.len()];
        Ok(Tables {
            ndf: self.nodes("ndf", &[])?,
            sigma: self.nodes("sigma", &[])?,
            vndf: self.nodes("vndf", &slices)?,
            luminance: self.nodes("luminance", &slices)?,
            jacobian: self.flag("jacobian")?,
            phi_i,
            theta_i,
        })
    }

    fn field(&self, name: &str) -> Result<&Field, Fault> {
        let name = format!("{}{name}", self.prefix);
        self.file.find(&name).ok_or_else(|| {
            let fields = self.file.fields();
            let mut names: Vec<_> = fields.iter().take(24).map(|f| f.name.as_str()).collect();
            if fields.len() > names.len() {
                names.push("…");
            }
            let found = match names.len() {
                0 => "no field".into(),
                _ => names.join(", "),
            };
            Fault::new("fields", found, format!("`{name}` among them"))
        })
    }

    /// A field of `f32` whose dimensions begin with `first`, and `rest` more.
    fn f32_field(&self, name: &str, first: &[usize], rest: usize) -> Result<&Field, Fault> {
        let field = self.field(name)?;
        let place = format!("field `{}`", field.name);
        if field.dtype != Dtype::F32 {
            return Err(Fault::new(place, field.dtype.name(), Dtype::F32.name()));
        }
        if field.shape.len() != first.len() + rest || !field.shape.starts_with(first) {
            let mut expected: Vec<_> = first.iter().map(usize::to_string).collect();
            expected.extend(std::iter::repeat_n("n".to_owned(), rest));
            return Err(Fault::new(
                place,
                format!("dimensions {}", dimensions_of(&field.shape)),
                format!("dimensions {}", expected.join("×")),
            ));
        }
        Ok(field)
    }

    /// A list of numbers.
    pub fn list(&self, name: &str) -> Result<Vec<f32>, Fault> {
        let field = self.f32_field(name, &[], 1)?;
        Ok(self.input.values(field.range.clone()).to_vec())
    }

    fn nodes(&self, name: &str, first: &[usize]) -> Result<Nodes, Fault> {
        let nodes = self.functions(name, first)?;
        let count = first.iter().product();
        check_size(name, [nodes.width, nodes.height, count], 1)?;
        Ok(nodes)
    }

    /// Functions over the unit square: a field whose dimensions are `first`, height and width.
    pub fn functions(&self, name: &str, first: &[usize]) -> Result<Nodes, Fault> {
        let field = self.f32_field(name, first, 2)?;
        Ok(Nodes {
            height: field.shape[first.len()],
            width: field.shape[first.len() + 1],
            values: self.input.values(field.range.clone()),
        })
    }

    fn flag(&self, name: &str) -> Result<bool, Fault> {
        let field = self.field(name)?;
        match (field.dtype, self.file.bytes_of(field)) {
            (Dtype::U8, [flag]) => Ok(*flag != 0),
            _ => {
                let shape = dimensions_of(&field.shape);
                Err(Fault::new(
                    format!("field `{}`", field.name),
                    format!("{} of dimensions {shape}", field.dtype.name()),
                    "one uint8",
                ))
            }
        }
    }
}

impl Tables {
    /// Adds everything but the values to a file, as [`Fields::tables`] reads it.
    pub(in super::super) fn write(&self, file: &mut TensorWriter, prefix: &str) {
        let name = |name: &str| format!("{prefix}{name}");
        let slices = [self.phi_i.len(), self.theta_i.len()];
        file.f32s(&name("phi_i"), &slices[..1], &self.phi_i);
        file.f32s(&name("theta_i"), &slices[1..], &self.theta_i);
        for (field, first, nodes) in [
            ("sigma", &[][..], &self.sigma),
            ("ndf", &[], &self.ndf),
            ("vndf", &slices, &self.vndf),
            ("luminance", &slices, &self.luminance),
        ] {
            let shape = [first, &[nodes.height, nodes.width]].concat();
            file.f32s(&name(field), &shape, &nodes.values);
        }
        file.bytes(&name("jacobian"), &[1], &[u8::from(self.jacobian)]);
    }
}
