//! The mutants of a file.

use std::ops::Range;
use std::path::{Path, PathBuf};

use proc_macro2::Span;
use syn::spanned::Spanned;
use syn::visit::{self, Visit};
use syn::{BinOp, Expr, Lit, ReturnType, Stmt, Type, UnOp};

/// How a mutant is written into its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// In place of an expression.
    Instead,
    /// A statement that is left out.
    LeftOut,
    /// Text put between others, in which `{}` is the question whether the mutant runs.
    Between,
}

pub struct Mutant {
    /// File, line, function, and what is changed.
    pub name: String,
    pub module: String,
    pub text: String,
}

pub struct Site {
    pub file: usize,
    pub at: Range<usize>,
    pub kind: Kind,
    pub mutants: Vec<usize>,
}

pub struct File {
    pub path: PathBuf,
    pub name: String,
    pub text: String,
}

#[derive(Default)]
pub struct Found {
    pub files: Vec<File>,
    pub sites: Vec<Site>,
    pub mutants: Vec<Mutant>,
}

impl Found {
    pub fn read(&mut self, path: &Path, name: &str) {
        let text = std::fs::read_to_string(path).expect("a file");
        let parsed = syn::parse_file(&text).expect("Rust");
        let mut lines = vec![0];
        lines.extend(text.match_indices('\n').map(|(at, _)| at + 1));
        self.files.push(File { path: path.to_owned(), name: name.to_owned(), text });
        Finder { found: self, lines, function: String::new() }.visit_file(&parsed);
    }
}

struct Finder<'a> {
    found: &'a mut Found,
    lines: Vec<usize>,
    function: String,
}

fn is_for_tests(attributes: &[syn::Attribute]) -> bool {
    attributes.iter().any(|it| {
        it.path().is_ident("test")
            || it.path().is_ident("cfg") && it.meta.require_list().is_ok_and(|it| it.tokens.to_string() == "test")
    })
}

fn has_let(it: &Expr) -> bool {
    match it {
        Expr::Let(_) => true,
        Expr::Binary(it) => has_let(&it.left) || has_let(&it.right),
        _ => false,
    }
}

impl Finder<'_> {
    fn text(&self) -> &str {
        &self.found.files.last().expect("a file").text
    }

    fn range(&self, span: Span) -> Range<usize> {
        let at = |place: proc_macro2::LineColumn| {
            let line = self.lines[place.line - 1];
            let before: usize = self.text()[line..].chars().take(place.column).map(char::len_utf8).sum();
            line + before
        };
        at(span.start())..at(span.end())
    }

    fn source(&self, of: &impl Spanned) -> String {
        self.text()[self.range(of.span())].to_owned()
    }

    fn add(&mut self, at: Range<usize>, kind: Kind, what: &str, texts: impl IntoIterator<Item = (String, String)>) {
        let file = self.found.files.len() - 1;
        let line = self.lines.partition_point(|it| *it <= at.start);
        let column = at.start - self.lines[line - 1] + 1;
        let of = self.found.files[file].name.clone();
        // where `if` negates a condition and changes it, both are mutants of one place
        let same = |it: &Site| it.file == file && it.at == at && it.kind == kind && kind == Kind::Instead;
        let site = self.found.sites.iter().rposition(same).unwrap_or_else(|| {
            self.found.sites.push(Site { file, at, kind, mutants: Vec::new() });
            self.found.sites.len() - 1
        });
        for (change, text) in texts {
            let name = format!("{of}:{line}:{column}: {what}{change} in {}", self.function);
            self.found.sites[site].mutants.push(self.found.mutants.len());
            self.found.mutants.push(Mutant { name, module: of.clone(), text });
        }
    }

    fn function(&mut self, signature: &syn::Signature, block: &syn::Block) {
        if signature.constness.is_some() {
            return;
        }
        let before = std::mem::replace(&mut self.function, signature.ident.to_string());
        let values = match &signature.output {
            ReturnType::Default => vec![String::new()],
            ReturnType::Type(_, of) => values(of),
        };
        let open = self.range(block.brace_token.span.open()).end;
        if !block.stmts.is_empty() {
            let texts = values.into_iter().map(|it| (format!(" with {it}"), format!(" if {{}} {{ return {it}; }}")));
            self.add(open..open, Kind::Between, "replaced", texts);
        }
        visit::visit_block(self, block);
        self.function = before;
    }

    fn condition(&mut self, it: &Expr) {
        if !matches!(it, Expr::Let(_) | Expr::Binary(_) | Expr::Unary(_)) {
            let text = self.source(it);
            self.add(self.range(it.span()), Kind::Instead, "negated", [(String::new(), format!("!({text})"))]);
        }
    }
}

/// What a function could return instead.
fn values(of: &Type) -> Vec<String> {
    let owned = |list: &[&str]| list.iter().map(|it| (*it).to_owned()).collect();
    let Type::Path(path) = of else { return owned(&["Default::default()"]) };
    let last = path.path.segments.last().expect("a name");
    match &*last.ident.to_string() {
        "bool" => owned(&["true", "false"]),
        "f64" => owned(&["0.0", "1.0", "-1.0"]),
        "usize" | "u64" | "u32" | "u8" => owned(&["0", "1"]),
        "i64" | "i32" => owned(&["0", "1", "-1"]),
        "Option" => {
            let mut all = owned(&["None"]);
            if let syn::PathArguments::AngleBracketed(inner) = &last.arguments
                && let Some(syn::GenericArgument::Type(inner)) = inner.args.first()
            {
                all.extend(values(inner).into_iter().map(|it| format!("Some({it})")));
            }
            all
        }
        _ => owned(&["Default::default()"]),
    }
}

fn others(op: &BinOp) -> &'static [&'static str] {
    match op {
        BinOp::Add(_) => &["-", "*"],
        BinOp::Sub(_) => &["+", "/"],
        BinOp::Mul(_) => &["+", "/"],
        BinOp::Div(_) => &["%", "*"],
        BinOp::Rem(_) => &["/", "+"],
        BinOp::And(_) => &["||"],
        BinOp::Or(_) => &["&&"],
        BinOp::Eq(_) => &["!="],
        BinOp::Ne(_) => &["=="],
        BinOp::Lt(_) => &["==", ">", "<="],
        BinOp::Le(_) => &[">"],
        BinOp::Gt(_) => &["==", "<", ">="],
        BinOp::Ge(_) => &["<"],
        BinOp::AddAssign(_) => &["-=", "*="],
        BinOp::SubAssign(_) => &["+=", "/="],
        BinOp::MulAssign(_) => &["+=", "/="],
        BinOp::DivAssign(_) => &["%=", "*="],
        BinOp::BitAnd(_) => &["|"],
        BinOp::BitOr(_) => &["&"],
        _ => &[],
    }
}

impl<'ast> Visit<'ast> for Finder<'_> {
    fn visit_attribute(&mut self, _: &'ast syn::Attribute) {}
    // what must be constant
    fn visit_pat(&mut self, _: &'ast syn::Pat) {}
    fn visit_type(&mut self, _: &'ast Type) {}
    fn visit_path(&mut self, _: &'ast syn::Path) {}
    fn visit_generics(&mut self, _: &'ast syn::Generics) {}
    fn visit_angle_bracketed_generic_arguments(&mut self, _: &'ast syn::AngleBracketedGenericArguments) {}
    fn visit_item_const(&mut self, _: &'ast syn::ItemConst) {}
    fn visit_impl_item_const(&mut self, _: &'ast syn::ImplItemConst) {}
    fn visit_item_static(&mut self, _: &'ast syn::ItemStatic) {}
    fn visit_item_enum(&mut self, _: &'ast syn::ItemEnum) {}
    fn visit_expr_const(&mut self, _: &'ast syn::ExprConst) {}
    fn visit_macro(&mut self, _: &'ast syn::Macro) {}

    fn visit_expr_repeat(&mut self, it: &'ast syn::ExprRepeat) {
        self.visit_expr(&it.expr);
    }

    fn visit_item_mod(&mut self, it: &'ast syn::ItemMod) {
        if !is_for_tests(&it.attrs) {
            visit::visit_item_mod(self, it);
        }
    }

    fn visit_item_fn(&mut self, it: &'ast syn::ItemFn) {
        if !is_for_tests(&it.attrs) {
            self.function(&it.sig, &it.block);
        }
    }

    fn visit_impl_item_fn(&mut self, it: &'ast syn::ImplItemFn) {
        if !is_for_tests(&it.attrs) {
            self.function(&it.sig, &it.block);
        }
    }

    fn visit_item_impl(&mut self, it: &'ast syn::ItemImpl) {
        if !is_for_tests(&it.attrs) {
            visit::visit_item_impl(self, it);
        }
    }

    fn visit_expr_if(&mut self, it: &'ast syn::ExprIf) {
        self.condition(&it.cond);
        visit::visit_expr_if(self, it);
    }

    fn visit_expr_while(&mut self, it: &'ast syn::ExprWhile) {
        self.condition(&it.cond);
        visit::visit_expr_while(self, it);
    }

    fn visit_arm(&mut self, it: &'ast syn::Arm) {
        if let Some((_, guard)) = &it.guard
            && !has_let(guard)
        {
            let texts = ["true", "false"].map(|it| (format!(" {it}"), it.to_owned()));
            self.add(self.range(guard.span()), Kind::Instead, "guard is", texts);
        }
        visit::visit_arm(self, it);
    }

    fn visit_expr_match(&mut self, it: &'ast syn::ExprMatch) {
        let rest = it.arms.iter().position(|arm| matches!(arm.pat, syn::Pat::Wild(_)) && arm.guard.is_none());
        for arm in &it.arms[..rest.unwrap_or(0)] {
            if arm.guard.is_none() {
                let end = self.range(arm.pat.span()).end;
                self.add(end..end, Kind::Between, "arm left out", [(String::new(), " if !{}".to_owned())]);
            }
        }
        visit::visit_expr_match(self, it);
    }

    fn visit_local(&mut self, it: &'ast syn::Local) {
        let Some(init) = &it.init else { return };
        self.visit_expr(&init.expr);
        if let Some((_, other)) = &init.diverge
            && let Expr::Block(other) = &**other
            && let [first @ .., last] = &other.block.stmts[..]
        {
            first.iter().for_each(|it| self.visit_stmt(it));
            // it must leave the function
            visit::visit_stmt(self, last);
        }
    }

    fn visit_stmt(&mut self, it: &'ast Stmt) {
        if let Stmt::Expr(inner, Some(_)) = it
            && matches!(
                inner,
                Expr::Call(_)
                    | Expr::MethodCall(_)
                    | Expr::Assign(_)
                    | Expr::Return(_)
                    | Expr::Break(_)
                    | Expr::Continue(_)
                    | Expr::Try(_)
            )
        {
            let text: String =
                self.source(inner).split_whitespace().collect::<Vec<_>>().join(" ").chars().take(60).collect();
            self.add(self.range(it.span()), Kind::LeftOut, "left out: ", [(text, String::new())]);
        }
        visit::visit_stmt(self, it);
    }

    fn visit_expr(&mut self, it: &'ast Expr) {
        let at = self.range(it.span());
        match it {
            Expr::Binary(two) if !has_let(it) => {
                let (left, right, op) = (self.source(&two.left), self.source(&two.right), self.source(&two.op));
                let assigns = op.ends_with('=') && !["==", "!=", "<=", ">="].contains(&&*op);
                let texts: Vec<_> = others(&two.op)
                    .iter()
                    .map(|other| {
                        let text = if assigns {
                            format!("{left} {other} {right}")
                        } else {
                            format!("({left}) {other} ({right})")
                        };
                        (format!("{op} to {other}"), text)
                    })
                    .collect();
                if !texts.is_empty() {
                    self.add(at, Kind::Instead, "", texts);
                }
            }
            Expr::Unary(one) if matches!(one.op, UnOp::Neg(_) | UnOp::Not(_)) => {
                let text = self.source(&one.expr);
                let sign = self.source(&one.op);
                self.add(at, Kind::Instead, "without ", [(sign, text)]);
            }
            Expr::Lit(literal) => {
                let text = self.source(it);
                let other = match &literal.lit {
                    Lit::Float(value) if value.base10_parse::<f64>().is_ok_and(|it| it == 0.0) => "1.0".to_owned(),
                    Lit::Float(_) => format!("2.0 * {text}"),
                    Lit::Int(_) => format!("{text} + 1"),
                    _ => return,
                };
                self.add(at, Kind::Instead, "", [(format!("{text} to {other}"), other)]);
            }
            // a constant, if it compiles
            Expr::Path(path)
                if path.path.segments.last().is_some_and(|it| {
                    let name = it.ident.to_string();
                    name.len() > 1
                        && !["MIN", "MAX", "INFINITY"].contains(&&*name)
                        && name.chars().all(|it| it.is_ascii_uppercase() || it.is_ascii_digit() || it == '_')
                }) =>
            {
                let text = self.source(it);
                self.add(at, Kind::Instead, "twice ", [(text.clone(), format!("({text} + {text})"))]);
            }
            _ => {}
        }
        visit::visit_expr(self, it);
    }
}
