"""Priors that see keyframes: where they begin, what training may change, what is stored."""

import numpy as np
import pytest
import torch

import projflow_lite as pf
from data_synth import make_clips
from data_synth.captions import phrases
from projflow_lite.prior import (
    Prior,
    conditioned,
    conditioned_training,
    load_prior,
    save_prior,
)
from projflow_lite.prior.checkpoint import read, write
from projflow_lite.prior.conditioned import LOUD, ControlledPrior, MaskedPrior, marked
from projflow_lite.prior.conditioned_files import (
    load_control_branch,
    load_masked_prior,
    save_control_branch,
    save_masked_prior,
)
from projflow_lite.prior.conditioned_training import (
    CONTROLLED,
    ConditionedRecipe,
    ConditionedTrainer,
    draw_known,
)
from projflow_lite.prior.small_training import RECIPES
from projflow_lite.prior.text import Vocabulary
from projflow_lite.prior.training import Recipe, begin, train
from projflow_lite.skeleton import JOINTS, LOWER_BODY

TINY = Recipe(steps=100, batch=24, widths=(32, 40), lengths=(20,), learning_rate=4e-3)
KINDS = [ControlledPrior, MaskedPrior]
NAMES = ["branch", "masked"]
FRAMES = 34


def fresh_prior(seed=0):
    """A prior before its first step, as its file would give it back."""
    torch.manual_seed(seed)
    motions = torch.as_tensor(make_clips(64, 60, seed=5).positions)
    mean = motions.mean((0, 1))
    std = float((motions - mean).square().mean().sqrt())
    prior = Prior(Vocabulary.of(phrases()), mean, std, (20, 196), {"widths": [16, 24]})
    for weight in prior.network.parameters():  # zeros of its own would hide what is passed on
        weight.data = (weight.data + 0.02 * torch.randn(weight.shape)).half().float()
    return prior.eval().requires_grad_(False)


def states(batch=2, frames=FRAMES, seed=0):
    return torch.randn(batch, frames, 22, 3, generator=torch.Generator().manual_seed(seed))


def keyframes(x, keys=(3, 17), joint=20):
    observed = torch.full_like(x, torch.nan)
    observed[:, list(keys), joint] = x[:, list(keys), joint]
    return observed


def scrambled(model, seed=1):
    """The same with noise on the weights that may learn: as if it had been trained."""
    random = torch.Generator().manual_seed(seed)
    for weight in model.learning():
        weight.data += (0.02 * torch.randn(weight.shape, generator=random)).half().float()
    return model


PLACES = ((0.0, None), (0.4, "a person walks"), (0.97, ["a person jumps", None]))


@pytest.mark.parametrize("kind", KINDS, ids=NAMES)
def test_before_training_it_is_the_plain_prior(kind):
    prior, x = fresh_prior(), states()
    model = kind.of(prior)
    for t, text in PLACES:
        assert torch.equal(model(x, t, text), prior(x, t, text))
        assert torch.equal(model.endpoint(x, t, text), prior.endpoint(x, t, text))


def test_a_branch_says_nothing_before_training_whatever_it_is_shown():
    prior, x = fresh_prior(), states()
    model = ControlledPrior.of(prior)
    for t, text in PLACES:
        assert torch.equal(model(x, t, text, keyframes(x)), prior(x, t, text))


def test_an_untrained_masked_prior_sees_known_coordinates_without_their_noise():
    """Without a hint, the plain prior on a state in which they are t y, and all else as it was."""
    prior, x = fresh_prior(), states()
    observed, t = keyframes(states(seed=3)), 0.4
    state = torch.where(observed.isnan(), x, t * observed)
    model = MaskedPrior.of(prior)
    torch.nn.init.zeros_(model.network.hint.weight)
    ours = model.endpoint(x, t, "a person walks", observed)
    torch.testing.assert_close(ours, prior.endpoint(state, t, "a person walks"))
    assert (ours - prior.endpoint(x, t, "a person walks")).abs().max() > 1e-3


@pytest.mark.parametrize("kind", KINDS, ids=NAMES)
def test_it_is_told_how_far_it_is_from_what_is_known_when_told_nothing(kind, monkeypatch):
    """Spied on; the miss of that endpoint, over 1.05 - t and the scale."""
    prior, x = fresh_prior(), states()
    model, told = scrambled(kind.of(prior)), []

    def spy(values):
        told.append(values)
        return marked(values)

    monkeypatch.setattr(conditioned, "marked", spy)
    observed, t = keyframes(states(seed=3)), 0.6
    model.endpoint(x, t, "a person walks", observed)
    # A branch is not asked: its prior is frozen, and predicts as it did before.
    untold = prior if kind is ControlledPrior else model
    miss = observed - untold.endpoint(x, t, "a person walks")
    torch.testing.assert_close(
        told[0], miss / prior.noise_std / (1.05 - t), equal_nan=True, atol=1e-4, rtol=1e-4
    )


def test_the_first_look_teaches_a_masked_prior_nothing_but_can_be_differentiated():
    network, x = MaskedPrior.of(fresh_prior()).network, states(1, 20).requires_grad_(True)
    t, ids = torch.tensor([0.6]), torch.zeros(1, 4, dtype=torch.long)
    (expected,) = torch.autograd.grad(network(x, t, ids).square().sum(), x)
    network.requires_grad_(True)
    network.untold(x, t, ids).square().sum().backward()
    torch.testing.assert_close(x.grad, expected)
    assert expected.abs().max() > 0.1
    assert all(weight.grad is None for weight in network.parameters())


@pytest.mark.parametrize("kind", KINDS, ids=NAMES)
def test_after_training_it_looks_at_what_is_known_and_at_nothing_else(kind):
    model, x = scrambled(kind.of(fresh_prior())), states()
    observed = keyframes(x)
    told = model(x, 0.4, None, observed)
    assert (told - model(x, 0.4)).abs().max() > 1e-3
    assert (told - model(x, 0.4, None, observed + 0.5)).abs().max() > 1e-3  # the value
    assert (told - model(x, 0.4, None, keyframes(x, (3,)))).abs().max() > 1e-3  # the mark
    zero = 0 * observed + model.mean  # 0 when scaled, as what is unknown is
    assert (model(x, 0.4, None, zero) - model(x, 0.4)).abs().max() > 1e-3


@pytest.mark.parametrize("kind", KINDS, ids=NAMES)
def test_nothing_known_is_the_same_as_nothing_said(kind):
    model, x = scrambled(kind.of(fresh_prior())), states()
    nothing = torch.full_like(x, torch.nan)
    assert torch.equal(model(x, 0.4, "a person walks", nothing), model(x, 0.4, "a person walks"))


@pytest.mark.parametrize("kind", KINDS, ids=NAMES)
def test_what_is_known_is_of_one_motion_of_each_or_repeated_in_turn(kind):
    model, x = scrambled(kind.of(fresh_prior())), states(4)
    observed = keyframes(x)
    whole = model(x, 0.4, None, observed)
    alone = torch.cat([model(x[i : i + 1], 0.4, None, observed[i]) for i in range(4)])
    torch.testing.assert_close(whole, alone, atol=1e-5, rtol=1e-5)
    turns = model(x, 0.4, None, observed[:2])
    torch.testing.assert_close(
        turns, model(x, 0.4, None, observed[:2].repeat(2, 1, 1, 1)), atol=0, rtol=0
    )
    assert model(x.double(), 0.4, None, observed.double()).dtype == torch.float64


def test_keyframes_are_seen_in_scaled_metres_with_marks_and_loud():
    """Worked out here: the mean goes out, the scale is the noise's, unknown is 0 and unmarked."""
    model, x = MaskedPrior.of(fresh_prior()), states()
    seen = marked(model.scaled(keyframes(x), x))
    assert seen.shape == (2, 132, 36)
    value = (x[0, 17, 20] - model.mean[20]) / model.noise_std
    torch.testing.assert_close(seen[0, 60:63, 17], LOUD * value)
    marks = torch.zeros(66, 36)
    marks[60:63, [3, 17]] = LOUD
    assert torch.equal(seen[1, 66:], marks)
    assert not seen[0, :66][marks == 0].any()


def test_masks_are_as_they_are_said_to_be():
    """Shares worked out by hand, within four standard errors of 20 000 draws."""
    count, frames = 20_000, 60
    known = draw_known(count, frames, torch.Generator().manual_seed(0))
    joints, keys, axes = known.any(3).any(1), known.any(3).any(2).sum(1), known.any(1).any(1)
    nothing = keys == 0
    legs = torch.tensor([name in LOWER_BODY for name in JOINTS])
    edit = (joints == legs).all(1)
    six = torch.tensor([name in CONTROLLED for name in JOINTS])
    usual = ~nothing & ~edit

    def share(which, expected, among=None):
        among = torch.ones_like(which) if among is None else among
        n = int(among.sum())
        found = float(which[among].float().mean())
        assert found == pytest.approx(expected, abs=4 * (expected * (1 - expected) / n) ** 0.5)

    share(nothing, 0.1)
    share(edit, 0.1)
    assert (keys[edit] == frames).all()
    assert not joints[usual][:, ~six].any()
    assert joints[usual].any(0)[six].all()
    many = joints.sum(1)
    assert set(many[usual].tolist()) == {1, 2, 3, 4, 5, 6}
    share(many == 1, (1 / 6) ** 0.5, usual)  # 1 + floor(6 u^2) = 1 for u^2 < 1/6
    share(keys == 1, np.log(2) / np.log(120), usual)  # floor(120^u) = 1
    share(keys == 60, np.log(2) / np.log(120), usual)  # and at least 60
    share(axes.sum(1) < 3, 0.1, usual)
    product = known.any(3).any(2)[:, :, None, None] & joints[:, None, :, None] & axes[:, None, None]
    assert torch.equal(known, product)


@pytest.fixture(scope="module")
def start(tmp_path_factory):
    """A tiny prior that has learnt a little."""
    folder = tmp_path_factory.mktemp("start")
    train(TINY, folder, progress=False)
    return folder / "prior.safetensors"


def recipe(start, branch, **changes):
    fields = {"batch": 24, "lengths": (20,), "learning_rate": 1e-2, "steps": 160}
    return ConditionedRecipe(branch=branch, start=str(start), **(fields | changes))


def pelvis_of_every_other(count, frames, random):
    """One easy lesson: the pelvis in all frames, for half of the motions."""
    known = torch.zeros(count, frames, 22, 3, dtype=torch.bool)
    known[::2, :, 0] = True
    return known


@pytest.mark.parametrize(("branch", "share"), [(True, 0.85), (False, 0.6)], ids=NAMES)
def test_a_short_training_teaches_it_to_look(start, branch, share, monkeypatch):
    """On fresh motions, told and untold with the same weights. A branch cannot do more than the
    frozen way out lets it, and that of a prior of a hundred steps lets it do little.
    """
    monkeypatch.setattr(conditioned_training, "draw_known", pelvis_of_every_other)
    trainer = ConditionedTrainer(recipe(start, branch))
    before = {k: v.clone() for k, v in load_prior(start).network.state_dict().items()}
    while trainer.step < trainer.recipe.steps:
        trainer.advance()
    model = trainer.result()
    if branch:
        for k, frozen in before.items():
            assert torch.equal(model.network.state_dict()[k], frozen)
            assert torch.equal(trainer.network.state_dict()[k], frozen)
    else:
        assert not torch.equal(model.network.state_dict()["enter.weight"], before["enter.weight"])
    x1 = torch.as_tensor(make_clips(64, 20, seed=99).positions)
    x_t = 0.5 * model.noise_std * states(64, 20) + 0.5 * x1
    observed = torch.full_like(x1, torch.nan)
    observed[:, :, 0] = x1[:, :, 0]
    untold, told = (
        (model.endpoint(x_t, 0.5, None, known) - x1)[:, :, 0].norm(dim=-1).mean()
        for known in (None, observed)
    )
    assert told < share * untold


@pytest.mark.parametrize("branch", [True, False], ids=NAMES)
def test_a_run_that_was_interrupted_ends_as_one_that_was_not(start, branch, tmp_path):
    short = recipe(start, branch, steps=4, batch=4)
    whole = train(short, tmp_path / "whole", progress=False)
    half = begin(short, tmp_path / "half")
    assert isinstance(half, ConditionedTrainer)
    while half.step < 2:
        half.advance()
    half.save(tmp_path / "half" / "run.safetensors")
    resumed = train(short, tmp_path / "half", progress=False)
    for name, weight in whole.state_dict().items():
        assert torch.equal(weight, resumed.state_dict()[name])
    assert resumed.recipe["start"] == str(start)


@pytest.mark.parametrize("branch", [True, False], ids=NAMES)
def test_a_perfect_network_has_no_loss_and_is_shown_coordinates_as_they_are(start, branch):
    trainer = ConditionedTrainer(recipe(start, branch, batch=12))
    u1, ids = trainer.batch()
    shown = []

    def perfect(x, t, ids, observed):
        shown.append(observed)
        return u1

    trainer.network.forward = perfect
    assert trainer.loss(u1, ids, torch.Generator().manual_seed(0)) == 0
    known = ~shown[0].isnan()
    assert 0 < known.sum() < known.numel()
    assert torch.equal(shown[0][known], u1[known])


def test_known_coordinates_count_once_more(start):
    """By hand: all joints off by 1 in x, so no velocity and no bone is wrong; 1/3, and 1/3 more."""
    trainer = ConditionedTrainer(recipe(start, branch=False, batch=2))
    u1, ids = trainer.batch()
    shift, seen = torch.tensor([1.0, 0.0, 0.0]), []

    def off(x, t, ids, observed):
        seen.append((t, observed))
        return u1 + shift

    trainer.network.forward = off
    loss = trainer.loss(u1, ids, torch.Generator().manual_seed(1))
    t, observed = seen[0]
    known = ~observed.isnan()
    of_known = known[..., 0].sum((1, 2)) / known.sum((1, 2, 3)).clamp(min=1)
    expected = ((1 / 3 + of_known) / ((1 - t) ** 2 + 0.005)).mean()
    assert float(loss) == pytest.approx(float(expected), rel=1e-4)


# ------------------------------------------------------------------------------------------ files


def test_a_masked_prior_comes_back(tmp_path):
    model, x = scrambled(MaskedPrior.of(fresh_prior())), states()
    save_masked_prior(model, tmp_path / "a.safetensors")
    again = load_masked_prior(tmp_path / "a.safetensors")
    assert again.start == model.start
    assert not any(weight.requires_grad for weight in again.parameters())
    answers = [m(x, 0.4, "a person walks", keyframes(x)) for m in (model, again)]
    torch.testing.assert_close(*answers, atol=2e-2, rtol=1e-2)  # half precision
    save_masked_prior(again, tmp_path / "b.safetensors")
    assert (tmp_path / "a.safetensors").read_bytes() == (tmp_path / "b.safetensors").read_bytes()


def test_a_branch_comes_back_to_its_prior_and_to_no_other(tmp_path):
    prior, x = fresh_prior(), states()
    model = scrambled(ControlledPrior.of(prior))
    save_control_branch(model, tmp_path / "a.safetensors")
    again = load_control_branch(tmp_path / "a.safetensors", prior)
    answers = [m(x, 0.4, "a person walks", keyframes(x)) for m in (model, again)]
    torch.testing.assert_close(*answers, atol=2e-2, rtol=1e-2)
    save_control_branch(again, tmp_path / "b.safetensors")
    assert (tmp_path / "a.safetensors").read_bytes() == (tmp_path / "b.safetensors").read_bytes()
    tensors, _ = read(tmp_path / "a.safetensors")
    assert all(name.startswith("network.branch.") for name in tensors)
    for other in (fresh_prior(seed=3), None):  # None is the shipped one
        with pytest.raises(ValueError, match=r"a\.safetensors was trained on another prior \(weig"):
            load_control_branch(tmp_path / "a.safetensors", other)
    with pytest.raises(ValueError, match="load_control_branch: prior is a Prior, not 'shipped'"):
        load_control_branch(tmp_path / "a.safetensors", "shipped")


def test_damaged_foreign_and_missing_files_are_named(tmp_path):
    prior, path = fresh_prior(), tmp_path / "x.safetensors"
    branch = ControlledPrior.of(prior)
    loaders = [load_masked_prior, lambda path: load_control_branch(path, prior)]
    save_prior(prior, path)
    for load, kind in zip(loaders, ("masked prior", "control branch"), strict=True):
        with pytest.raises(FileNotFoundError, match="there is no checkpoint at"):
            load(tmp_path / "nothing.safetensors")
        with pytest.raises(ValueError, match=rf"x\.safetensors is not a projflow_lite {kind}"):
            load(path)
    save_control_branch(branch, path)
    with pytest.raises(ValueError, match=r"x\.safetensors is not a projflow_lite masked prior"):
        load_masked_prior(path)
    tensors, about = read(path)
    tensors.pop("network.branch.hint.weight")
    write(tensors, about, path)
    with pytest.raises(ValueError, match=r"x\.safetensors does not fit its own description"):
        loaders[1](path)
    path.write_bytes(path.read_bytes()[:-1])
    for load in loaders:
        with pytest.raises(ValueError, match=r"x\.safetensors is damaged or is not a checkpoint"):
            load(path)


@pytest.mark.parametrize(
    ("load", "name"), [(load_masked_prior, "masked"), (load_control_branch, "control_branch")]
)
def test_without_the_shipped_file_it_is_said_how_to_make_one(load, name, tmp_path, monkeypatch):
    monkeypatch.setattr("projflow_lite.prior.conditioned_files.files", lambda package: tmp_path)
    with pytest.raises(FileNotFoundError, match=f"no {name}.safetensors; .* --recipe {name}, and"):
        load()
    assert name in RECIPES


@pytest.mark.parametrize("kind", KINDS, ids=NAMES)
def test_wrong_shapes_are_refused(kind):
    model, x = kind.of(fresh_prior()), states(4)
    match = (
        r"what is known of motions of shape \(4, 34, 22, 3\) has the shape \(34, 22, 3\), or one"
    )
    for wrong in (x[:, :20], x[:3], x[:0], x[0, 0]):
        with pytest.raises(ValueError, match=match):
            model(x, 0.4, None, wrong)
    with pytest.raises(ValueError, match="500 frames; it was trained on motions of 20 to 196"):
        pf.sample(model, None, frames=500)
