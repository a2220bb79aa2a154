"""The parameters as a tree for a view: groups, and a row for each parameter."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from PySide6.QtCore import (
    QAbstractItemModel,
    QModelIndex,
    QObject,
    QPersistentModelIndex,
    QSortFilterProxyModel,
    Qt,
    Signal,
)

from app.gui.views.parameter_editor.draft import Draft, Kind, kinds
from app.gui.views.parameter_editor.naming import Display, group_title, titles
from core.parameters import Parameters

Index = QModelIndex | QPersistentModelIndex
ROW_ROLE = Qt.ItemDataRole.UserRole
NAME_COLUMN, VALUE_COLUMN = 0, 1


@dataclass(frozen=True)
class RowFacts:
    """What a view shows of one parameter.

    Attributes:
        name: dotted name.
        title: what people call it.
        kind: what sort of value.
        is_optional: whether None is possible and means automatic.
        value: now.
        preset_value: the preset's.
        display: how values are written.
        error: why the value just entered was refused, or "".
    """

    name: str
    title: str
    kind: Kind
    is_optional: bool
    value: Any
    preset_value: Any
    display: Display
    error: str

    @property
    def differs(self) -> bool:
        """Whether it differs from the preset."""
        return bool(self.value != self.preset_value)


@dataclass(eq=False)
class _Node:
    name: str
    title: str
    parent: _Node | None = None
    is_group: bool = True
    children: list[_Node] = field(default_factory=list)

    def child(self, name: str, title: str, is_group: bool) -> _Node:
        """The child of that name, made if need be."""
        found = next((node for node in self.children if node.name == name), None)
        if found is None:
            found = _Node(name, title, self, is_group)
            self.children.append(found)
        return found

    def leaves(self) -> Iterator[_Node]:
        for node in self.children:
            if node.is_group:
                yield from node.leaves()
            else:
                yield node


class ParameterModel(QAbstractItemModel):
    """Groups and parameters, two columns: name and value.

    Attributes:
        edited: the new Parameters after a value was set through `set_value`.
    """

    edited = Signal(object)

    def __init__(self, groups: Sequence[str], parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._draft = Draft(Parameters(), Parameters())
        self._kinds = kinds()
        self._titles = titles(list(self._draft.facts.values()))
        self._root = _Node("", "")
        for name in self._draft.facts:
            if not groups or name.split(".")[0] in groups:
                self._add(name)

    def _add(self, name: str) -> None:
        *group_names, _ = name.split(".")
        node = self._root
        for depth, group in enumerate(group_names):
            node = node.child(".".join(group_names[: depth + 1]), group_title(group), is_group=True)
        node.child(name, self._titles[name], is_group=False)

    @property
    def parameters(self) -> Parameters:
        """As they are now, also those not shown."""
        return self._draft.parameters

    def names(self) -> list[str]:
        """Return the dotted names of the parameters shown, in their order."""
        return [node.name for node in self._root.leaves()]

    def n_different(self) -> int:
        """Return how many of those shown differ from the preset."""
        return sum(self._draft.differs(name) for name in self.names())

    def load(self, parameters: Parameters, preset: Parameters) -> None:
        """Show other parameters, without a signal of `edited`."""
        before = self._rows()
        self._draft.load(parameters, preset)
        self._tell(before)

    def set_value(self, name: str, value: Any) -> None:
        """Enter a value; the row tells if it is refused."""
        before = self._rows()
        has_changed = self._draft.set(name, value)
        self._tell(before)
        if has_changed:
            self.edited.emit(self._draft.parameters)

    def _rows(self) -> list[RowFacts]:
        return [self.row_facts(name) for name in self.names()]

    def row_facts(self, name: str) -> RowFacts:
        """Return what is shown of a parameter."""
        kind, is_optional = self._kinds[name]
        return RowFacts(
            name=name,
            title=self._titles[name],
            kind=kind,
            is_optional=is_optional,
            value=self._draft.value(name),
            preset_value=self._draft.preset_value(name),
            display=self._draft.displays[name],
            error=self._draft.errors.get(name, ""),
        )

    def index_of(self, name: str, column: int = NAME_COLUMN) -> QModelIndex:
        """Return the index of a parameter or a group; invalid when it is not shown."""
        return self._find(self._root, name, column)

    def _find(self, node: _Node, name: str, column: int) -> QModelIndex:
        for row, child in enumerate(node.children):
            if child.name == name:
                return self.createIndex(row, column, child)
            found = self._find(child, name, column)
            if found.isValid():
                return found
        return QModelIndex()

    def _tell(self, before: list[RowFacts]) -> None:
        """Say which rows are not what they were; each alone, for their heights may differ, too."""
        for facts in before:
            if self.row_facts(facts.name) != facts:
                index = self.index_of(facts.name)
                self.dataChanged.emit(index, index.siblingAtColumn(VALUE_COLUMN))

    def _node(self, index: Index | None) -> _Node:
        if index is None or not index.isValid():
            return self._root
        node = index.internalPointer()
        assert isinstance(node, _Node)
        return node

    def index(self, row: int, column: int, parent: Index | None = None) -> QModelIndex:
        """Return the index of a row under a group."""
        children = self._node(parent).children
        return self.createIndex(row, column, children[row]) if 0 <= row < len(children) else QModelIndex()

    def parent(self, index: Index) -> QModelIndex:  # type: ignore[override]  # QObject.parent() is another
        """Return the group of an index."""
        above = self._node(index).parent
        if above is None or above.parent is None:
            return QModelIndex()
        return self.createIndex(above.parent.children.index(above), 0, above)

    def rowCount(self, parent: Index | None = None) -> int:
        """Return the number of rows in a group."""
        return 0 if parent is not None and parent.column() > 0 else len(self._node(parent).children)

    def columnCount(self, _parent: Index | None = None) -> int:
        """Return 2: name and value."""
        return 2

    def flags(self, index: Index) -> Qt.ItemFlag:
        """Groups can only be opened; yes or no is toggled, not edited."""
        flags = Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsSelectable
        node = self._node(index)
        if not node.is_group and index.column() == VALUE_COLUMN and self._kinds[node.name][0] != "yes_no":
            flags |= Qt.ItemFlag.ItemIsEditable
        return flags

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        """Return title or value as text; the whole row as `RowFacts` under `ROW_ROLE`."""
        node = self._node(index)
        if node.is_group:
            is_title = role == Qt.ItemDataRole.DisplayRole and index.column() == NAME_COLUMN
            return node.title if is_title else None
        facts = self.row_facts(node.name)
        if role == ROW_ROLE:
            return facts
        if role == Qt.ItemDataRole.DisplayRole:
            return node.title if index.column() == NAME_COLUMN else facts.display.text(facts.value)
        if role == Qt.ItemDataRole.EditRole:
            return facts.value
        if role == Qt.ItemDataRole.ToolTipRole:
            return facts.display.tooltip()
        return None


class ParameterFilter(QSortFilterProxyModel):
    """Shows the parameters whose names or descriptions hold a text, or that differ, and their groups."""

    def __init__(self, model: ParameterModel) -> None:
        super().__init__(model)
        self._text = ""
        self._only_different = False
        self._model = model
        self.setRecursiveFilteringEnabled(True)
        self.setSourceModel(model)

    def index_of(self, name: str) -> QModelIndex:
        """Return the index of a parameter's value; invalid when it is not shown."""
        return self.mapFromSource(self._model.index_of(name, VALUE_COLUMN))

    def set_filter(self, text: str, only_different: bool) -> None:
        """Show what matches."""
        self.beginFilterChange()
        self._text = text.casefold()
        self._only_different = only_different
        self.endFilterChange(QSortFilterProxyModel.Direction.Rows)

    def filterAcceptsRow(self, row: int, parent: Index) -> bool:
        """Parameters are judged; a group is shown with the first of its parameters."""
        model = self.sourceModel()
        facts = model.index(row, 0, parent).data(ROW_ROLE)
        if not isinstance(facts, RowFacts):
            return False
        if self._only_different and not facts.differs and not facts.error:
            return False
        words = f"{facts.title} {facts.name} {facts.name.replace('_', ' ')} {facts.display.facts.doc}"
        return self._text in words.casefold()
