"""What a further round of the search does not ask again."""

from types import SimpleNamespace

from workbench.tracing.criteria import Criteria
from workbench.tracing.lazy import HOPE, MUCH, Lazy

SHARE = Criteria().share


def candidate(effect: str, instead: tuple[str, ...] = ()):
    return SimpleNamespace(key=f"{effect}@axis", kind="addition", instead=instead)


def judgement(effect: str, gain: float, **more):
    return SimpleNamespace(candidate=candidate(effect, **more), score=SimpleNamespace(gain=gain), theta=())


def state(left: float):
    return SimpleNamespace(errors=SimpleNamespace(total=left))


def asked(lazy: Lazy, left: float, everything: bool = False) -> set[str]:
    asks = lazy.beside(state(left), everything)
    return {n for n in ("gravity", "cogging", "creep", "backlash") if asks(candidate(n))}


def after_a_round() -> Lazy:
    lazy = Lazy(Criteria())
    nothing, little = judgement("gravity", -0.01), judgement("cogging", 2 * HOPE * SHARE)
    without_value = judgement("creep", 0.0)
    without_value.theta = None
    lazy.noted([nothing, little, without_value], state(1.0))
    return lazy


def test_what_took_nothing_is_not_asked_again_while_hardly_less_is_left():
    # creep had no value beside another plant, and backlash was not asked
    assert asked(after_a_round(), 0.9) == {"cogging", "creep", "backlash"}


def test_everything_is_asked_again_once_a_plain_part_is_taken():
    assert asked(after_a_round(), 0.9 * MUCH) == {"gravity", "cogging", "creep", "backlash"}


def test_everything_is_asked_again_beside_what_was_added_before_it_was_certain():
    assert asked(after_a_round(), 0.9, everything=True) == {"gravity", "cogging", "creep", "backlash"}


def test_what_took_little_grows_with_what_was_taken_since():
    lazy = Lazy(Criteria())
    lazy.noted([judgement("cogging", 0.8 * HOPE * SHARE)], state(1.0))
    assert "cogging" not in asked(lazy, 0.95)
    assert "cogging" in asked(lazy, 0.7)  # as much power is a larger share of it


def test_a_friction_in_the_place_of_a_declared_one_is_another_candidate_than_beside_it():
    lazy = Lazy(Criteria())
    lazy.noted([judgement("creep", 0.0, instead=("coulomb_friction@axis",))], state(1.0))
    asks = lazy.beside(state(0.9), everything=False)
    assert asks(candidate("creep"))
    assert not asks(candidate("creep", ("coulomb_friction@axis",)))
