//! Which modules, items, imports and names does the syntax tree of a file hold?

use proc_macro2::{Ident, TokenStream, TokenTree};
use syn::punctuated::Punctuated;
use syn::visit::{self, Visit};
use syn::{Attribute, Item as SynItem, UseTree, Visibility};

use super::file::{Import, Item, Name, Scope, Seen};

/// The modules of the file whose text is given; the file's own is first.
pub(crate) fn scopes_of(text: &str) -> Result<Vec<Scope>, syn::Error> {
    let file = syn::parse_file(text)?;
    if is_only_for_tests(&file.attrs) {
        return Ok(vec![Scope::default()]);
    }
    let mut reader = Reader {
        scopes: vec![Scope::default()],
        at: 0,
        blocks: 0,
    };
    reader.visit_file(&file);
    Ok(reader.scopes)
}

struct Reader {
    scopes: Vec<Scope>,
    /// The scope that is being read.
    at: usize,
    /// How many function bodies stand round what is being read.
    blocks: usize,
}

impl Reader {
    fn scope(&mut self) -> &mut Scope {
        &mut self.scopes[self.at]
    }

    fn name(&mut self, ident: &Ident, is_import: bool) {
        let (text, line) = (plain(ident), ident.span().start().line);
        self.scope().names.push(Name {
            text,
            line,
            is_import,
        });
    }

    fn item(&mut self, ident: &Ident, vis: &Visibility, is_type: bool) {
        if self.blocks > 0 {
            return;
        }
        let item = Item {
            name: plain(ident),
            line: ident.span().start().line,
            is_type,
            seen: seen(vis),
        };
        self.scope().items.push(item);
    }

    fn declare(&mut self, item: &SynItem) {
        match item {
            SynItem::Const(i) => self.item(&i.ident, &i.vis, false),
            SynItem::Fn(i) => self.item(&i.sig.ident, &i.vis, false),
            SynItem::Static(i) => self.item(&i.ident, &i.vis, false),
            SynItem::Enum(i) => self.item(&i.ident, &i.vis, true),
            SynItem::Struct(i) => self.item(&i.ident, &i.vis, true),
            SynItem::Trait(i) => self.item(&i.ident, &i.vis, true),
            SynItem::TraitAlias(i) => self.item(&i.ident, &i.vis, true),
            SynItem::Type(i) => self.item(&i.ident, &i.vis, true),
            SynItem::Union(i) => self.item(&i.ident, &i.vis, true),
            SynItem::Macro(i) => {
                if let Some(ident) = &i.ident {
                    self.item(ident, &Visibility::Inherited, false);
                }
            }
            _ => {}
        }
    }

    fn import(&mut self, tree: &UseTree, before: &[String], hands_on: bool) {
        let mut path = before.to_vec();
        let name = match tree {
            UseTree::Path(part) => {
                self.name(&part.ident, true);
                path.push(plain(&part.ident));
                return self.import(&part.tree, &path, hands_on);
            }
            UseTree::Group(group) => {
                return group
                    .items
                    .iter()
                    .for_each(|tree| self.import(tree, before, hands_on));
            }
            UseTree::Glob(_) => None,
            UseTree::Name(leaf) => {
                self.name(&leaf.ident, true);
                path.push(plain(&leaf.ident));
                path.pop_if(|last| last == "self");
                path.last().cloned()
            }
            UseTree::Rename(leaf) => {
                self.name(&leaf.ident, true);
                path.push(plain(&leaf.ident));
                path.pop_if(|last| last == "self");
                Some(plain(&leaf.rename))
            }
        };
        self.scope().imports.push(Import {
            path,
            name,
            hands_on,
        });
    }

    /// Macros take what they like: whatever looks like a path in them is one.
    fn tokens(&mut self, tokens: TokenStream) {
        let mut path: Vec<String> = Vec::new();
        let mut colons = 0;
        for token in tokens {
            match token {
                TokenTree::Ident(ident) => {
                    self.name(&ident, false);
                    if colons != 2 {
                        self.path(std::mem::take(&mut path));
                    }
                    path.push(plain(&ident));
                    colons = 0;
                }
                TokenTree::Punct(punct) if punct.as_char() == ':' => colons += 1,
                other => {
                    self.path(std::mem::take(&mut path));
                    colons = 0;
                    if let TokenTree::Group(group) = other {
                        self.tokens(group.stream());
                    }
                }
            }
        }
        self.path(path);
    }

    fn path(&mut self, path: Vec<String>) {
        if path.len() > 1 {
            self.scope().paths.push(path);
        }
    }
}

impl<'ast> Visit<'ast> for Reader {
    fn visit_item(&mut self, item: &'ast SynItem) {
        if is_only_for_tests(attributes(item)) {
            return;
        }
        self.scope().defines |= !matches!(item, SynItem::Mod(_) | SynItem::Use(_));
        self.declare(item);
        visit::visit_item(self, item);
    }

    fn visit_item_mod(&mut self, module: &'ast syn::ItemMod) {
        let name = plain(&module.ident);
        self.name(&module.ident, false);
        let Some((_, items)) = &module.content else {
            return self.scope().children.push(name);
        };
        let mut inside = self.scope().inside.clone();
        inside.push(name);
        let outer = self.at;
        self.at = self.scopes.len();
        self.scopes.push(Scope {
            inside,
            ..Scope::default()
        });
        items.iter().for_each(|item| self.visit_item(item));
        self.at = outer;
    }

    fn visit_item_use(&mut self, import: &'ast syn::ItemUse) {
        if import.leading_colon.is_none() {
            let hands_on = seen(&import.vis) > Seen::Here;
            self.import(&import.tree, &[], hands_on);
        }
    }

    fn visit_block(&mut self, block: &'ast syn::Block) {
        self.blocks += 1;
        visit::visit_block(self, block);
        self.blocks -= 1;
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        if path.leading_colon.is_none() {
            let names = path.segments.iter().map(|part| plain(&part.ident));
            self.path(names.collect());
        }
        visit::visit_path(self, path);
    }

    fn visit_impl_item(&mut self, item: &'ast syn::ImplItem) {
        let attributes = match item {
            syn::ImplItem::Const(i) => &i.attrs,
            syn::ImplItem::Fn(i) => &i.attrs,
            _ => return visit::visit_impl_item(self, item),
        };
        if !is_only_for_tests(attributes) {
            visit::visit_impl_item(self, item);
        }
    }

    fn visit_local(&mut self, local: &'ast syn::Local) {
        if !is_only_for_tests(&local.attrs) {
            visit::visit_local(self, local);
        }
    }

    fn visit_field(&mut self, field: &'ast syn::Field) {
        if !is_only_for_tests(&field.attrs) {
            visit::visit_field(self, field);
        }
    }

    fn visit_variant(&mut self, variant: &'ast syn::Variant) {
        if !is_only_for_tests(&variant.attrs) {
            visit::visit_variant(self, variant);
        }
    }

    fn visit_arm(&mut self, arm: &'ast syn::Arm) {
        if !is_only_for_tests(&arm.attrs) {
            visit::visit_arm(self, arm);
        }
    }

    fn visit_ident(&mut self, ident: &'ast Ident) {
        self.name(ident, false);
    }

    fn visit_token_stream(&mut self, tokens: &'ast TokenStream) {
        self.tokens(tokens.clone());
    }

    fn visit_attribute(&mut self, _: &'ast Attribute) {}

    fn visit_visibility(&mut self, _: &'ast Visibility) {}
}

/// The identifier without `r#`.
fn plain(ident: &Ident) -> String {
    let text = ident.to_string();
    text.strip_prefix("r#").map(str::to_owned).unwrap_or(text)
}

fn seen(vis: &Visibility) -> Seen {
    match vis {
        Visibility::Public(_) => Seen::Everywhere,
        Visibility::Restricted(to) if !to.path.is_ident("self") => Seen::Crate,
        _ => Seen::Here,
    }
}

/// Is there a `cfg(test)`, alone or among what must all hold?
fn is_only_for_tests(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        attribute.path().is_ident("cfg")
            && attribute
                .parse_args::<syn::Meta>()
                .is_ok_and(|condition| needs_test(&condition))
    })
}

fn needs_test(condition: &syn::Meta) -> bool {
    let parts = Punctuated::<syn::Meta, syn::Token![,]>::parse_terminated;
    condition.path().is_ident("test")
        || condition.path().is_ident("all")
            && condition.require_list().is_ok_and(|list| {
                list.parse_args_with(parts)
                    .is_ok_and(|parts| parts.iter().any(needs_test))
            })
}

fn attributes(item: &SynItem) -> &[Attribute] {
    match item {
        SynItem::Const(i) => &i.attrs,
        SynItem::Enum(i) => &i.attrs,
        SynItem::ExternCrate(i) => &i.attrs,
        SynItem::Fn(i) => &i.attrs,
        SynItem::ForeignMod(i) => &i.attrs,
        SynItem::Impl(i) => &i.attrs,
        SynItem::Macro(i) => &i.attrs,
        SynItem::Mod(i) => &i.attrs,
        SynItem::Static(i) => &i.attrs,
        SynItem::Struct(i) => &i.attrs,
        SynItem::Trait(i) => &i.attrs,
        SynItem::TraitAlias(i) => &i.attrs,
        SynItem::Type(i) => &i.attrs,
        SynItem::Union(i) => &i.attrs,
        SynItem::Use(i) => &i.attrs,
        _ => &[],
    }
}
