"""No module of the package imports itself by way of others, at its top or inside a function."""

import ast
from graphlib import CycleError, TopologicalSorter

from syntax_trees import PACKAGE, import_statements, parsed, syntax_trees


def module_name(path, root):
    parts = [root.name, *path.relative_to(root).with_suffix("").parts]
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def targets(node, module, is_package):
    """Full names that an import statement may stand for."""
    if isinstance(node, ast.Import):
        return [a.name for a in node.names]
    base = node.module or ""
    if node.level:
        parts = module.split(".")
        kept = parts[: len(parts) - node.level + is_package]
        base = ".".join([*kept, *([node.module] if node.module else [])])
    return [f"{base}.{a.name}" for a in node.names]


def imports_of(root, trees=None):
    """Module -> modules of the same package that it imports, at any depth of its code."""
    trees = trees or parsed(root)
    paths = {module_name(p, root): p for p in trees}
    graph = {}
    for module, path in paths.items():
        tree = trees[path]
        names = [
            name
            for node in import_statements(tree, for_types=False)
            for name in targets(node, module, path.name == "__init__.py")
        ]
        # `from .folder import name` needs the module `name`, or the folder that defines `name`
        modules = {n if n in paths else n.rpartition(".")[0] for n in names}
        graph[module] = (modules & paths.keys()) - {module}
    return graph


def circle_in(graph):
    """One circle of imports, first module = last module; [] where there is none."""
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return error.args[1]
    return []


def test_no_module_imports_itself_by_way_of_others():
    graph = imports_of(PACKAGE, syntax_trees())
    assert len(graph) > 100
    assert circle_in(graph) == []
