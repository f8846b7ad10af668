"""A scene: tables that go together, checked."""

from collections.abc import Sequence
from typing import Self

from pydantic import PrivateAttr, model_validator
from pydantic_core import PydanticCustomError

from idealgas.scene.checks.issues import issues
from idealgas.scene.tables.document import Document
from idealgas.toml.error import Issue
from idealgas.toml.origin import Origin
from idealgas.toml.table import Table


class Scene(Document):
    """A whole scene, checked: its numbers are in range, its discs fit, its run has an end."""

    _origin: Origin = PrivateAttr(default_factory=Origin)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if found := list(issues(self)):
            raise PydanticCustomError("issues", "{summary}", {"summary": str(found[0]), "issues": found})
        return self

    def resolved(self) -> Self:
        """This scene with all defaults filled in that follow from other tables."""
        update: dict[str, Table] = {}
        if self.piston:
            update["piston"] = self.piston.model_copy(update={"position": self.piston.start(self.box.size)})
        if self.restitution and not self.restitution.elastic:
            update["restitution"] = self.restitution.model_copy(update={"contact_duration": self.contact_duration})
        return self.model_copy(update=update)

    def from_origin(self, origin: Origin) -> Self:
        """This scene, knowing where it was written."""
        self._origin = origin
        return self

    def report(self, issues: Sequence[Issue]) -> list[str]:
        """One line for each issue found after the scene was checked, with file and line of the key that it is about."""
        return self._origin.report(issues)
