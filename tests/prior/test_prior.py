"""The tiny flow: what it accepts, what it stores, and that training is exact to the step."""

import json
import shutil
import signal
from dataclasses import replace

import numpy as np
import pytest
import torch
from scipy.interpolate import BSpline

import projflow_lite as pf
from data_synth import make_clips
from data_synth.captions import phrases
from projflow_lite.prior import training
from projflow_lite.prior.checkpoint import read, write
from projflow_lite.prior.loss import loss_of
from projflow_lite.prior.loss_log import read_loss, stored_runs
from projflow_lite.prior.network import bones_to_positions, draw, spline_kernel
from projflow_lite.prior.signals import undivided
from projflow_lite.prior.text import TextEncoder, Vocabulary
from projflow_lite.prior.training import RECIPES, Trainer, begin, learning_rate, train
from projflow_lite.skeleton import EDGES, JOINTS

SMOKE = replace(RECIPES["smoke"], steps=6, batch=4)
SHORT = replace(SMOKE, lengths=(20,))


@pytest.fixture(scope="module")
def trained(tmp_path_factory):
    folder = tmp_path_factory.mktemp("run")
    return train(SMOKE, folder, progress=False), folder


@pytest.fixture(scope="module")
def short(tmp_path_factory):
    return train(SHORT, tmp_path_factory.mktemp("short"), progress=False)


def weights(prior):
    return torch.cat([w.flatten() for w in prior.network.parameters()])


def test_bone_vectors_add_up_along_the_skeleton():
    bones = torch.randn(22, 3)
    positions = bones_to_positions() @ bones
    torch.testing.assert_close(positions[0], bones[0])
    for parent, child in EDGES:
        torch.testing.assert_close(positions[child] - positions[parent], bones[child])


def test_the_spline_is_scipys():
    points = np.random.default_rng(0).normal(size=12)
    ours = draw(torch.as_tensor(points)[None, None], spline_kernel().double())[0, 0].numpy()
    # Point k lies at frame 2 k + 0.5; scipy's basis on knots two frames apart peaks at its middle.
    knots = 2.0 * np.arange(-2, 14) + 0.5
    curve = BSpline(knots, points, 3, extrapolate=False)
    np.testing.assert_allclose(ours[3:-3], curve(np.arange(3, 21)), atol=1e-6)


def test_the_spline_goes_on_as_a_straight_line():
    points = torch.stack([2.0 * torch.arange(9) + 0.5, torch.full((9,), 3.0)])[None]
    frames = torch.stack([torch.arange(18.0), torch.full((18,), 3.0)])[None]
    torch.testing.assert_close(draw(points, spline_kernel()), frames)


def test_nothing_trembles_faster_than_the_control_points(trained):
    """Whatever the input, less than a hundredth of the output's power lies above 7 Hz."""
    prior, _ = trained
    out = prior.endpoint(torch.randn(4, 80, 22, 3), 0.9)[:, 8:72] - prior.mean
    power = torch.fft.rfft(out * torch.hann_window(64).view(1, -1, 1, 1), dim=1).abs().square()
    frequency = torch.fft.rfftfreq(64, 1 / 20)
    assert power[:, frequency > 7].sum() < 0.01 * power[:, frequency > 0.5].sum()


@pytest.mark.parametrize("frames", [20, 21, 59, 60, 77, 196])
def test_velocity_points_from_where_we_are_to_the_endpoint(trained, frames):
    prior, _ = trained
    x = prior.noise_std * torch.randn(2, frames, 22, 3)
    v = prior(x, 0.75, ["a person walks", None])
    assert v.shape == x.shape
    torch.testing.assert_close(x + 0.25 * v, prior.endpoint(x, 0.75, ["a person walks", None]))


def test_a_batch_is_its_members_and_every_time_may_differ(trained):
    prior, _ = trained
    x, t = torch.randn(3, 60, 22, 3), torch.tensor([0.0, 0.5, 0.9])
    prompts = ["a person waves", None, "a person walks forward"]
    together = prior.endpoint(x, t, prompts)
    for i in range(3):
        alone = prior.endpoint(x[i : i + 1], float(t[i]), [prompts[i]])
        torch.testing.assert_close(together[i : i + 1], alone, atol=1e-4, rtol=1e-4)


def test_the_prompt_matters_and_no_prompt_is_not_an_empty_one_by_accident():
    encoder, words = TextEncoder(5, 16), torch.tensor([[1, 2], [2, 1], [0, 0], [1, 0]])
    torch.nn.init.normal_(encoder.nothing)
    out = encoder(words)
    torch.testing.assert_close(out[2], encoder.nothing)
    assert (out[0] - out[3]).abs().max() > 1e-3
    padded = encoder(torch.nn.functional.pad(words, (0, 4)))
    torch.testing.assert_close(padded, out)


def test_unknown_words_are_reported_and_left_out():
    vocabulary = Vocabulary.of(["a person walks", "a person jumps"])
    assert vocabulary.words == ("a", "jumps", "person", "walks")
    with pytest.warns(UserWarning, match=r"prompt: the prior never saw 'pirouettes', 'gladly'"):
        ids = vocabulary.encode(["A person pirouettes gladly!", None])
    assert ids.tolist() == [[1, 3], [0, 0]]


def test_the_warning_names_who_never_saw_the_word():
    with pytest.warns(UserWarning, match="prompt: the evaluator never saw 'jumps'"):
        Vocabulary(["walks"]).encode(["walks", "jumps"], "evaluator")


def test_the_vocabulary_is_what_clips_are_called_and_no_more():
    captions = make_clips(4096, frames=60, seed=1).captions
    assert Vocabulary.of(phrases()).words == Vocabulary.of(captions).words


def test_every_recipe_knows_the_words_of_the_shipped_prior():
    assert Trainer(SHORT).prior.vocabulary.words == (pf.load_prior().vocabulary.words)


def test_float64_in_is_float64_out(trained):
    prior, _ = trained
    assert prior(torch.randn(1, 60, 22, 3, dtype=torch.float64), 0.5).dtype == torch.float64


def test_a_perfect_network_has_no_loss():
    u1 = torch.randn(4, 60, 22, 3)
    loss = loss_of(lambda x, t, ids: u1, u1, torch.zeros(4, 1), torch.Generator().manual_seed(0))
    assert loss == 0


def test_training_lowers_the_loss():
    trainer = Trainer(replace(SMOKE, steps=60, batch=16))
    motions, words = trainer.batch()

    def loss_now():
        with torch.no_grad():
            random = torch.Generator().manual_seed(0)
            return float(loss_of(trainer.network, motions, words, random))

    before = loss_now()
    while trainer.step < 60:
        trainer.advance()
    assert loss_now() < 0.6 * before


def test_a_run_that_was_interrupted_ends_as_one_that_was_not(trained, tmp_path):
    def stop(step, loss):
        if step == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        train(SMOKE, tmp_path, progress=False, on_step=stop)
    assert not (tmp_path / "prior.safetensors").exists()
    resumed = train(SMOKE, tmp_path, progress=False)
    assert torch.equal(weights(resumed), weights(trained[0]))


@pytest.fixture
def usual_signals():
    """As in a shell's foreground: a program in its background is born deaf to Ctrl+C."""
    usual = {signal.SIGINT: signal.default_int_handler, signal.SIGTERM: signal.SIG_DFL}
    before = {number: signal.signal(number, handler) for number, handler in usual.items()}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.usefixtures("usual_signals")
@pytest.mark.parametrize("sign", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("moment", ["loss_of", "learning_rate"])
def test_a_signal_in_the_middle_of_a_step_waits_for_its_end(
    short, tmp_path, monkeypatch, moment, sign
):
    """`learning_rate` is asked between the gradient and the new weights."""
    plain, calls = getattr(training, moment), []

    def interrupted(*given):
        calls.append(1)
        if len(calls) == 3:
            signal.raise_signal(sign)
        return plain(*given)

    monkeypatch.setattr(training, moment, interrupted)
    with pytest.raises(KeyboardInterrupt if sign == signal.SIGINT else SystemExit):
        train(SHORT, tmp_path, progress=False)
    assert int(read(tmp_path / "run.safetensors")[1]["step"]) == 3
    resumed = train(SHORT, tmp_path, progress=False)
    assert torch.equal(weights(resumed), weights(short))


def test_signals_have_their_old_meaning_after_a_step():
    before = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)]
    with undivided():
        assert signal.getsignal(signal.SIGINT) is not before[0]
    assert [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)] == before


def test_a_run_cut_off_between_two_checkpoints_has_the_same_curve(tmp_path, monkeypatch):
    """As after a power cut: the checkpoint is of step 31, the log of step 50, its end torn."""
    recipe = replace(SHORT, steps=100, batch=2)
    whole, cut = tmp_path / "whole", tmp_path / "cut"

    def power_cut(step, loss):
        monkeypatch.setattr(training, "SAVE_EVERY", 0.0 if step == 30 else 1e9)
        if step == 31:
            shutil.copytree(whole, cut)
        if step == 60:
            shutil.copy(whole / "loss.jsonl", cut)

    one = train(recipe, whole, progress=False, on_step=power_cut)
    with (cut / "loss.jsonl").open("a") as log:
        log.write('{"step": 1')
    assert begin(recipe, cut).step == 31
    two = train(recipe, cut, progress=False)
    assert torch.equal(weights(one), weights(two))
    assert (cut / "loss.jsonl").read_bytes() == (whole / "loss.jsonl").read_bytes()


def test_the_curve_is_the_smoothed_loss(tmp_path):
    losses = []
    recipe = replace(SHORT, steps=50, batch=2)
    train(recipe, tmp_path, progress=False, on_step=lambda step, loss: losses.append(loss))
    smooth = losses[0]
    for loss in losses[1:]:
        smooth += 0.02 * (loss - smooth)
    np.testing.assert_allclose(read_loss(tmp_path / "loss.jsonl"), [[50, smooth]])


def test_the_shipped_priors_curve_is_that_of_its_recipe():
    assert "shipped" in stored_runs()
    steps, loss = read_loss("shipped").T
    np.testing.assert_array_equal(steps, np.arange(50, pf.load_prior().recipe["steps"] + 1, 50))
    assert loss[-1] < 0.05 * loss[0]


def test_a_curve_that_is_none_is_named(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"no log at .*loss\.jsonl"):
        read_loss(tmp_path / "loss.jsonl")
    (tmp_path / "loss.jsonl").write_text('{"step": 50}\n')
    with pytest.raises(ValueError, match=r"loss\.jsonl is not the log of a run"):
        read_loss(tmp_path / "loss.jsonl")


def test_a_run_with_other_words_or_another_network_is_refused(trained, tmp_path):
    tensors, about = read(trained[1] / "run.safetensors")
    path = tmp_path / "run.safetensors"
    write(tensors, about | {"words": '["walks"]'}, path)
    with pytest.raises(ValueError, match=r"run\.safetensors knows other words"):
        begin(SMOKE, tmp_path)
    write({k: v for k, v in tensors.items() if k != "weight.enter.weight"}, about, path)
    with pytest.raises(ValueError, match=r"run\.safetensors belongs to another network"):
        begin(SMOKE, tmp_path)


def test_a_checkpoint_comes_back_as_it_was(trained, tmp_path):
    prior, _ = trained
    pf.prior.save_prior(prior, tmp_path / "p.safetensors", torch.float32)
    again = pf.load_prior(tmp_path / "p.safetensors")
    assert torch.equal(weights(again), weights(prior))
    assert again.vocabulary.words == prior.vocabulary.words
    assert (again.noise_std, again.lengths, again.recipe) == (
        prior.noise_std,
        (20, 196),
        prior.recipe,
    )


@pytest.mark.parametrize("keep", [0, 7, 1000, -1])
def test_a_truncated_checkpoint_is_named_and_never_half_loaded(trained, tmp_path, keep):
    data = (trained[1] / "prior.safetensors").read_bytes()
    path = tmp_path / "cut.safetensors"
    path.write_bytes(data[:keep])
    with pytest.raises(ValueError, match=r"cut\.safetensors is damaged or is not a checkpoint"):
        pf.load_prior(path)


def test_other_files_are_refused(trained, tmp_path):
    with pytest.raises(FileNotFoundError, match="there is no checkpoint at"):
        pf.load_prior(tmp_path / "nothing.safetensors")
    with pytest.raises(ValueError, match="is not a projflow_lite prior"):
        pf.load_prior(trained[1] / "run.safetensors")


def test_a_folder_of_another_recipe_is_not_overwritten(trained):
    with pytest.raises(ValueError, match="was made by another recipe; choose another folder"):
        train(replace(SMOKE, seed=1), trained[1], progress=False)


def test_a_damaged_run_is_named(trained, tmp_path):
    (tmp_path / "run.safetensors").write_bytes((trained[1] / "run.safetensors").read_bytes()[:5000])
    with pytest.raises(ValueError, match=r"run\.safetensors is damaged"):
        train(SMOKE, tmp_path, progress=False)


def test_wrong_shapes_lengths_and_prompts_are_refused(trained):
    prior, _ = trained
    with pytest.raises(
        ValueError, match=r"prior: expected shape \(batch, frames, 22, 3\), got \(60, 22, 3\)"
    ):
        prior(torch.zeros(60, 22, 3), 0.5)
    with pytest.raises(
        ValueError, match="prior: 500 frames; it was trained on motions of 20 to 196"
    ):
        pf.sample(prior, frames=500)
    with pytest.raises(ValueError, match="prompt: 3 prompts for 2 motions"):
        prior(torch.zeros(2, 60, 22, 3), 0.5, ["a", "b", "c"])


def test_the_log_has_a_line_every_fifty_steps(tmp_path):
    train(replace(SMOKE, steps=50, batch=2), tmp_path, progress=False)
    line = json.loads((tmp_path / "loss.jsonl").read_text())
    assert line["step"] == 50
    assert np.isfinite(line["loss"])


def test_a_second_round_starts_the_learning_rate_anew_at_half_its_height():
    recipe = replace(RECIPES["classroom"], steps=1500, restart=1000, learning_rate=1.0)
    rates = [learning_rate(recipe, step) for step in range(1500)]
    assert max(rates[:1000]) == 1
    assert rates[999] < 1e-4
    assert rates[1000] == 0.5
    assert max(rates[1000:]) == 0.5
    assert rates[-1] < 1e-4


def test_feet_count_as_much_as_they_are_told_to():
    """By hand: a shift of the left ankle alone has no velocity and changes two bones."""
    u1 = torch.randn(8, 20, 22, 3, generator=torch.Generator().manual_seed(1))
    ids = torch.zeros(8, 1).long()
    shift = torch.zeros(22, 3)
    shift[JOINTS.index("left_ankle"), 0] = 1.0
    times = []

    def predict(x, t, ids):
        times.append(t)
        return u1 + shift

    for feet in (1.0, 8.0):
        loss = float(loss_of(predict, u1, ids, torch.Generator().manual_seed(0), feet))
        square = feet / ((18 + 4 * feet) / 22) / 66 + 2 * 2 / 63
        expected = (square / ((1 - times[-1]) ** 2 + 0.005)).mean()
        assert loss == pytest.approx(float(expected), rel=1e-5)


def test_late_limbs_keep_their_length_and_early_they_need_not(trained):
    network = trained[0].network
    bones = network.take_apart @ torch.randn(4, 40, 22, 3)

    def change(t):
        even = network.even_limbs(bones, torch.full((4,), t))
        torch.testing.assert_close(even[:, :, 0], bones[:, :, 0])
        length = (even[:, :, 1:] + network.usual[1:]).norm(dim=-1)
        return (length.std(1) / length.mean(1)).max()

    assert change(1.0) < 1e-4
    assert change(0.5) > 0.1


def test_limbs_of_real_lengths_are_left_as_they_are(trained):
    prior, _ = trained
    made = torch.as_tensor(make_clips(4, frames=40, seed=5).positions)
    bones = prior.network.take_apart @ ((made - prior.mean) / prior.noise_std)
    even = prior.network.even_limbs(bones, torch.ones(4))
    torch.testing.assert_close(even, bones, atol=1e-4, rtol=0)
