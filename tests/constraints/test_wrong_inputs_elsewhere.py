"""What samplers, adapters, motions, files, scores, data and equations refuse, in one line each.

What wishes, cameras, rows and the projector refuse is in test_wrong_inputs.py.
"""

import pickle
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
import torch
from refusals import check_refusal
from safetensors.torch import save_file
from test_wrong_inputs import WRONG as WRONG_WISHES

import projflow_lite as pf
from data_synth.dataset import make_clips
from projflow_lite import equations as eq
from projflow_lite import scores, skeleton
from projflow_lite.samplers import Adapter, GuideSettings, flow_times, guided

X = np.random.default_rng(0).normal(size=(9, 22, 3))
BATCH = pf.Motion(np.zeros((3, 4, 22, 3)))
L = eq.kinematic_laplacian(skeleton.EDGES, 22)
TEMPORARY = TemporaryDirectory()
FOLDER = Path(TEMPORARY.name)
SHIPPED = Path(pf.__file__).parent / "prior" / "shipped.safetensors"
EVALUATOR = Path(pf.__file__).parent / "scores" / "evaluator.safetensors"


@cache
def prior():
    return pf.load_prior()


@cache
def judge():
    return scores.load_evaluator()


def VELOCITY(x_t, t, text=None):
    return -x_t


def sample(wish=None, prior=VELOCITY, **options):
    return pf.sample(prior, wish, **({"frames": 12, "steps": 2} | options))


def one_value(value):
    x = np.zeros((4, 22, 3))
    x[2, 5, 1] = value
    return x


def damaged(name, change):
    path = FOLDER / name
    pf.Motion(X).save(path)
    path.write_bytes(change(path.read_bytes()))
    return path


def archive(name, **arrays):
    np.savez(FOLDER / name, **arrays)
    return FOLDER / name


def checkpoint(name, change):
    path = FOLDER / f"{name}.safetensors"
    path.write_bytes(change(EVALUATOR.read_bytes()))
    return path


def with_words(name, metadata):
    path = FOLDER / f"{name}.safetensors"
    save_file({"mean": torch.zeros(22, 3)}, path, metadata)
    return path


WRONG = [
    # sample
    ("no prior", lambda: pf.sample(None), "sample: prior is a callable velocity(x_t, t, text); try pf.load_prior()"),
    ("a word for a prior", lambda: pf.sample("prior"), "sample: prior is a callable velocity(x_t, t, text); try pf.load_prior()"),
    ("a prior's path for a prior", lambda: pf.sample(Path("shipped.safetensors")), "sample: prior is a callable velocity(x_t, t, text); try pf.load_prior()"),
    ("a word for a wish", lambda: sample("left_wrist"), "sample: wish is made by pin and its neighbours, not a str"),
    ("a function that makes a wish, for a wish", lambda: sample(pf.loop), "sample: wish is made by pin and its neighbours, not a function"),
    ("a list of wishes", lambda: sample([pf.loop()]), "sample: wish is made by pin and its neighbours, not a list"),
    ("a wish for a frame the motion lacks", lambda: sample(pf.pin("head", 12, [0, 0, 0])), "pin: frame 12 is outside 0..11"),
    ("a wish for a longer motion", lambda: sample(pf.keep(np.zeros((60, 22, 3)), "head")), "keep: 60 frames to keep in a motion of 12 frames"),
    ("a wish that contradicts itself", lambda: sample(pf.pin("head", [1, 1], [[0, 0, 0], [0, 0, 1]])), "rows 2 and 5 contradict each other: head, frame 1, z = 0 and 1"),
    ("half a frame", lambda: sample(frames=12.5), "sample: frames is a whole number of at least 1, not 12.5"),
    ("no frame", lambda: sample(frames=0), "sample: frames is a whole number of at least 1, not 0"),
    ("a negative number of frames", lambda: sample(frames=-12), "sample: frames is a whole number of at least 1, not -12"),
    ("True frames", lambda: sample(frames=True), "sample: frames is a whole number of at least 1, not True"),
    ("frames in words", lambda: sample(frames="60"), "sample: frames is a whole number of at least 1, not '60'"),
    ("None for frames", lambda: sample(frames=None), "sample: frames is a whole number of at least 1, not None"),
    ("a list of frames", lambda: sample(frames=[12]), "sample: frames is a whole number of at least 1, not [12]"),
    ("no steps", lambda: sample(steps=0), "sample: steps is a whole number of at least 1, not 0"),
    ("half a step", lambda: sample(steps=2.5), "sample: steps is a whole number of at least 1, not 2.5"),
    ("True steps", lambda: sample(steps=True), "sample: steps is a whole number of at least 1, not True"),
    ("steps in words", lambda: sample(steps="20"), "sample: steps is a whole number of at least 1, not '20'"),
    ("a solver that is none", lambda: sample(solver="heun"), "sample: solver is one of euler, multistep, not 'heun'"),
    ("a solver that is a number", lambda: sample(solver=2), "sample: solver is one of euler, multistep, not 2"),
    ("multistep where there is none", lambda: sample(pf.pin("head", 0, [0, 1, 2]), method="ddnm", solver="multistep"), "sample: ddnm makes Euler's steps and has no use for solver='multistep'; leave it out, or take projflow"),
    ("times that stop half way", lambda: sample(steps=[0, 0.5]), "sample: steps is a whole number, or flow times that rise from 0 to 1"),
    ("times that fall", lambda: sample(steps=[0, 0.6, 0.5, 1]), "sample: steps is a whole number, or flow times that rise from 0 to 1"),
    ("a time twice", lambda: sample(steps=[0, 0.5, 0.5, 1]), "sample: steps is a whole number, or flow times that rise from 0 to 1"),
    ("times that begin late", lambda: sample(steps=[0.1, 1]), "sample: steps is a whole number, or flow times that rise from 0 to 1"),
    ("times with NaN", lambda: sample(steps=[0, np.nan, 1]), "sample: steps is a whole number, or flow times that rise from 0 to 1"),
    ("one time", lambda: sample(steps=[1.0]), "sample: steps is a whole number, or flow times that rise from 0 to 1"),
    ("no times", lambda: sample(steps=[]), "sample: steps is a whole number, or flow times that rise from 0 to 1"),
    ("times in words", lambda: sample(steps=["0", "1"]), "sample: steps should be a regular array of numbers, not text"),
    ("complex times", lambda: sample(steps=[0j, 1 + 0j]), "sample: steps should be a regular array of numbers, not complex numbers"),
    ("a table of times", lambda: sample(steps=np.zeros((2, 2))), "sample: steps is a whole number, or flow times that rise from 0 to 1"),
    ("a seed in words", lambda: sample(seed="a"), "sample: seed is a whole number, not 'a'"),
    ("half a seed", lambda: sample(seed=1.5), "sample: seed is a whole number, not 1.5"),
    ("True for a seed", lambda: sample(seed=True), "sample: seed is a whole number, not True"),
    ("None for a seed", lambda: sample(seed=None), "sample: seed is a whole number, not None"),
    ("a seed beyond 64 bits", lambda: sample(seed=2**70), "sample: seed is a whole number, not 1180591620717411303424"),
    ("a method misspelt", lambda: sample(method="projflo"), "sample: method is one of projflow…, not 'projflo'"),
    ("a method by its function", lambda: sample(method=pf.samplers.projflow), "sample: method is one of projflow…, not <function projflow at …"),
    ("a list of methods", lambda: sample(method=["projflow"]), "sample: method is one of projflow…, not ['projflow']"),
    ("no motion in the batch", lambda: sample(batch=0), "sample: batch is a whole number of at least 1, not 0"),
    ("True for a batch", lambda: sample(batch=True), "sample: batch is a whole number of at least 1, not True"),
    ("half a batch", lambda: sample(batch=2.5), "sample: batch is a whole number of at least 1, not 2.5"),
    ("a guidance of NaN", lambda: sample(guidance=np.nan), "sample: guidance is a number, usually 0 to 5, not nan"),
    ("a guidance beyond all use", lambda: sample(guidance=1e6), "sample: guidance is a number, usually 0 to 5, not 1000000.0"),
    ("a guidance in words", lambda: sample(guidance="x"), "sample: guidance is a number, usually 0 to 5, not 'x'"),
    ("True for a guidance", lambda: sample(guidance=True), "sample: guidance is a number, usually 0 to 5, not True"),
    ("a guidance for each motion", lambda: sample(guidance=[1.0, 2.0]), "sample: guidance is a number, usually 0 to 5, not [1.0, 2.0]"),
    ("a number for guides", lambda: sample(guides=3), "sample: guides is True, False or GuideSettings(...), not 3"),
    ("a word for guides", lambda: sample(guides="off"), "sample: guides is True, False or GuideSettings(...), not 'off'"),
    ("a metric misspelt, sampling", lambda: sample(pf.loop(), metric="kinetic"), "Projector: metric is one of kinematic, euclidean, not 'kinetic'"),
    ("a metric of 21 joints, sampling", lambda: sample(pf.loop(), metric=np.eye(21)), "Projector: a metric is a symmetric (22, 22) matrix"),
    ("whole numbers as dtype", lambda: sample(dtype=torch.int32), "sample: dtype is torch.float32 or torch.float64, not torch.int32"),
    ("half precision, sampling", lambda: sample(dtype=torch.float16), "sample: dtype is torch.float32 or torch.float64, not torch.float16"),
    ("numpy's dtype", lambda: sample(dtype=np.float32), "sample: dtype is torch.float32 or torch.float64, not <class 'numpy.float32'>"),
    ("a number for a prompt", lambda: sample(prompt=3), "prompt: a prompt is a text, or a list of them, not 3"),
    ("a list of numbers for prompts", lambda: sample(prompt=[3]), "prompt: a prompt is a text, or a list of them, not [3]"),
    ("too many prompts for the batch", lambda: sample(prompt=["a", "b", "c"], batch=2), "prompt: 3 prompts for 2 motions"),
    ("two prompts for one motion", lambda: sample(prompt=["a", "b"]), "prompt: 2 prompts for 1 motions"),
    ("a share of noise without a wish", lambda: sample(eta=0.5), "sample: without a wish there is no eta; leave it out, or add a wish"),
    ("a share of noise above one", lambda: sample(pf.loop(), eta=1.5), "projflow: eta is a share of 0 to 1, not 1.5"),
    ("a negative share of noise", lambda: sample(pf.loop(), eta=-0.1), "projflow: eta is a share of 0 to 1, not -0.1"),
    ("a share of noise of NaN", lambda: sample(pf.loop(), eta=np.nan), "projflow: eta is a share of 0 to 1, not nan"),
    ("True as a share of noise", lambda: sample(pf.loop(), eta=True), "projflow: eta is 'paper', 'ddpm', a number or a function, not True"),
    ("a callback that is no function", lambda: sample(pf.loop(), callback=3), "projflow: callback is a function of a Step, not 3"),
    ("a share of noise misspelt", lambda: sample(pf.loop(), eta="papper"), "projflow: eta is …, not 'papper'"),
    ("a share of noise from a function that forgets to return", lambda: sample(pf.loop(), eta=lambda t: None), "projflow: eta is …, not …"),
    ("a noise misspelt", lambda: sample(pf.loop(), noise="orignal"), "projflow: noise is 'original' or 'implied', not 'orignal'"),
    ("an option that no method has", lambda: sample(pf.loop(), temperature=2.0), "projflow() got an unexpected keyword argument 'temperature'", TypeError),
    ("a prior that returns a column", lambda: sample(pf.loop(), prior=lambda x, t, text=None: x[..., :1]), "sample: the prior returned an array of shape (1, 12, 22, 1) for a state of shape (1, 12, 22, 3)"),
    ("a prior that returns one frame", lambda: sample(pf.loop(), prior=lambda x, t, text=None: x[:, :1]), "sample: the prior returned an array of shape (1, 1, 22, 3) for a state of shape (1, 12, 22, 3)"),
    ("a prior that returns nothing", lambda: sample(pf.loop(), prior=lambda x, t, text=None: None), "sample: the prior returned None for a state of shape (1, 12, 22, 3)"),
    ("a prior that returns an array", lambda: sample(pf.loop(), prior=lambda x, t, text=None: x.numpy()), "sample: the prior returned an array of shape (1, 12, 22, 3) for a state of shape (1, 12, 22, 3)"),
    ("a prior that returns NaN", lambda: sample(pf.loop(), prior=lambda x, t, text=None: x * np.nan), "Motion: pelvis, frame 0, x is not finite"),
    ("a prior that returns one frame, without a wish", lambda: sample(prior=lambda x, t, text=None: x[:, :1]), "sample: the prior returned an array of shape (1, 1, 22, 3) for a state of shape (1, 12, 22, 3)"),
    # the shipped prior
    ("a motion shorter than the prior knows", lambda: pf.sample(prior(), frames=19), "prior: 19 frames; it was trained on motions of 20 to 196"),
    ("a motion longer than the prior knows", lambda: pf.sample(prior(), frames=197), "prior: 197 frames; it was trained on motions of 20 to 196"),
    ("a state of 21 joints", lambda: prior()(torch.zeros(1, 60, 21, 3), 0.5), "prior: expected shape (batch, frames, 22, 3), got (1, 60, 21, 3)"),
    ("a state without a batch", lambda: prior()(torch.zeros(60, 22, 3), 0.5), "prior: expected shape (batch, frames, 22, 3), got (60, 22, 3)"),
    # flow_times
    ("no flow times", lambda: flow_times([]), "sample: steps is a whole number, or flow times that rise from 0 to 1"),
    ("times by a word", lambda: flow_times("01"), "sample: steps is a whole number, or flow times that rise from 0 to 1"),
    ("a negative number of steps", lambda: flow_times(-1), "sample: steps is a whole number, or flow times that rise from 0 to 1"),
    ("zero steps", lambda: flow_times(0), "sample: steps is a whole number, or flow times that rise from 0 to 1"),
    ("None for flow times", lambda: flow_times(None), "sample: steps is a whole number, or flow times that rise from 0 to 1"),
    ("half a flow step", lambda: flow_times(2.5), "sample: steps is a whole number, or flow times that rise from 0 to 1"),
    ("True for flow times", lambda: flow_times(True), "sample: steps is a whole number, or flow times that rise from 0 to 1"),
    # guidance
    ("a scale of NaN", lambda: guided(VELOCITY, np.nan), "guided: scale is a number, usually 0 to 5, not nan"),
    ("a scale of guidance in words", lambda: guided(VELOCITY, "1"), "guided: scale is a number, usually 0 to 5, not '1'"),
    # Adapter
    ("a layout without axes", lambda: Adapter(VELOCITY, layout="batch frames joints"), "Adapter: layout names batch, frames, joints, axes once each, not 'batch frames joints'"),
    ("a layout with a dimension twice", lambda: Adapter(VELOCITY, layout="batch batch joints axes"), "Adapter: layout names batch, frames, joints, axes once each, not 'batch batch joints axes'"),
    ("a layout with a dimension misspelt", lambda: Adapter(VELOCITY, layout="batch frame joints axes"), "Adapter: layout names batch, frames, joints, axes once each, not 'batch frame joints axes'"),
    ("a layout as a list", lambda: Adapter(VELOCITY, layout=["batch", "frames", "joints", "axes"]), "Adapter: layout is a text with closed parentheses, not ['batch', 'frames', 'joints', 'axes']"),
    ("a layout with an open parenthesis", lambda: Adapter(VELOCITY, layout="batch frames (joints axes"), "Adapter: layout is a text with closed parentheses, not 'batch frames (joints axes'"),
    ("a layout of nested parentheses", lambda: Adapter(VELOCITY, layout="batch (frames (joints axes))"), "Adapter: layout is a text with closed parentheses, not 'batch (frames (joints axes))'"),
    ("a std of zero on one axis", lambda: Adapter(VELOCITY, std=[1.0, 0.0, 1.0]), "Adapter: std is above 0 everywhere"),
    ("a negative std of the data", lambda: Adapter(VELOCITY, std=-1.0), "Adapter: std is above 0 everywhere"),
    ("a std of the data in words", lambda: Adapter(VELOCITY, std="1"), "Adapter: std should be a regular array of numbers, not text"),
    ("a mean of NaN", lambda: Adapter(VELOCITY, mean=np.nan), "Adapter: mean has a value that is not finite"),
    ("a mean in words", lambda: Adapter(VELOCITY, mean="zero"), "Adapter: mean should be a regular array of numbers, not text"),
    ("a complex mean", lambda: Adapter(VELOCITY, mean=1j), "Adapter: mean should be a regular array of numbers, not complex numbers"),
    ("a mean for 22 axes", lambda: Adapter(VELOCITY, mean=np.zeros(22)), "Adapter: mean has shape (22,), not (22, 3)"),
    ("a std for 21 joints", lambda: Adapter(VELOCITY, std=np.ones((21, 3))), "Adapter: std has shape (21, 3), not (22, 3)"),
    ("a model that is none", lambda: Adapter("model")(torch.zeros(2, 4, 22, 3), 0.0), "Adapter: velocity is a function, not 'model'"),
    ("a word for noise_at_one", lambda: Adapter(VELOCITY, noise_at_one="no"), "Adapter: noise_at_one is True or False, not 'no'"),
    ("a model that returns another shape", lambda: Adapter(lambda u, t, text: u[0])(torch.zeros(2, 4, 22, 3), 0.0), "Adapter: the model returned (4, 22, 3) for (2, 4, 22, 3); does it predict a velocity?"),
    ("a model that returns nothing", lambda: Adapter(lambda u, t, text: None)(torch.zeros(2, 4, 22, 3), 0.0), "Adapter: the model returned None for (2, 4, 22, 3); does it predict a velocity?"),
    # Guides
    ("guides of a form that there is not", lambda: GuideSettings(form="derived"), "guides: form is 'printed' or 'released', not 'derived'"),
    ("a trust of zero at least", lambda: GuideSettings(pi_min=0.0), "guides: trust is bounded by 0 < pi_min <= pi_max <= 1, not 0.0 and 0.99"),
    ("a trust above one", lambda: GuideSettings(pi_max=1.5), "guides: trust is bounded by 0 < pi_min <= pi_max <= 1, not 0.02 and 1.5"),
    ("bounds of trust that are swapped", lambda: GuideSettings(pi_min=0.9, pi_max=0.1), "guides: trust is bounded by 0 < pi_min <= pi_max <= 1, not 0.9 and 0.1"),
    ("a radius of NaN", lambda: GuideSettings(l_max=np.nan), "guides: l_max is a finite number, not nan"),
    ("True as a strength", lambda: GuideSettings(c0=True), "guides: c0 is a finite number, not True"),
    ("a strength in words", lambda: GuideSettings(c0="strong"), "guides: c0 is a finite number, not 'strong'"),
    ("an infinite exponent", lambda: GuideSettings(p=np.inf), "guides: p is a finite number, not inf"),
    ("radii of guides that are swapped", lambda: GuideSettings(l_min=12.0), "guides: radii are 0 <= l_min <= l_max, not 12.0 and 10.0"),
    ("a negative radius", lambda: GuideSettings(l_min=-1.0), "guides: radii are 0 <= l_min <= l_max, not -1.0 and 10.0"),
    ("a trust that grows", lambda: GuideSettings(tau_min=1.5), "guides: tau_min is a share of 0 to 1, not 1.5"),
    ("a negative strength", lambda: GuideSettings(c0=-3.0), "guides: c0 and lambda_s are at least 0 and p above, not -3.0, 1.0 and 2.0"),
    ("an exponent of zero", lambda: GuideSettings(p=0.0), "guides: c0 and lambda_s are at least 0 and p above, not 3.0, 1.0 and 0.0"),
    ("a trust of NaN", lambda: GuideSettings(pi_min=np.nan), "guides: pi_min is a finite number, not nan"),
    # Motion
    ("positions of 21 joints", lambda: pf.Motion(np.zeros((4, 21, 3))), "Motion: expected shape (..., frames, 22, 3), got (4, 21, 3)"),
    ("a motion of a plane", lambda: pf.Motion(np.zeros((4, 22, 2))), "Motion: expected shape (..., frames, 22, 3), got (4, 22, 2)"),
    ("a motion without frames", lambda: pf.Motion(np.zeros((22, 3))), "Motion: expected shape (..., frames, 22, 3), got (22, 3)"),
    ("a motion of no frames", lambda: pf.Motion(np.zeros((0, 22, 3))), "Motion: expected shape (..., frames, 22, 3), got (0, 22, 3)"),
    ("a motion with NaN", lambda: pf.Motion(one_value(np.nan)), "Motion: right_knee, frame 2, y is not finite"),
    ("a motion with infinity", lambda: pf.Motion(one_value(np.inf)), "Motion: right_knee, frame 2, y is not finite"),
    ("a motion in words", lambda: pf.Motion("walk"), "Motion: positions should be a regular array of numbers, not text"),
    ("a complex motion", lambda: pf.Motion(np.zeros((4, 22, 3), complex)), "Motion: positions should be a regular array of numbers, not complex numbers"),
    ("a motion of True and False", lambda: pf.Motion(np.zeros((4, 22, 3), bool)), "Motion: positions should be a regular array of numbers, not True and False"),
    ("a masked motion", lambda: pf.Motion(np.ma.masked_less(one_value(-1.0), 0)), "Motion: positions should be a regular array of numbers, not masked numbers"),
    ("a prompt that is a number", lambda: pf.Motion(np.zeros((4, 22, 3)), 3), "Motion: one prompt for each of 1 motions, not 3"),
    ("prompts for another batch", lambda: pf.Motion(np.zeros((3, 4, 22, 3)), ["a", "b"]), "Motion: one prompt for each of 3 motions, not ['a', 'b']"),
    ("a wish that is a word, in a motion", lambda: pf.Motion(np.zeros((4, 22, 3)), wish="loop"), "Motion: not a wish: 'loop'"),
    ("no frames a second", lambda: pf.Motion(np.zeros((4, 22, 3)), fps=0), "Motion: fps is a number above 0, not 0"),
    ("NaN frames a second", lambda: pf.Motion(np.zeros((4, 22, 3)), fps=np.nan), "Motion: fps is a number above 0, not nan"),
    ("frames a second in words", lambda: pf.Motion(np.zeros((4, 22, 3)), fps="20"), "Motion: fps is a number above 0, not '20'"),
    ("a joint that a motion has not", lambda: pf.Motion(np.zeros((4, 22, 3))).joint("tail"), "Motion.joint: 'tail' is not a joint; the joints are pelvis, spine1 to spine3, neck, head, and left_ or right_ hip, knee, ankle, foot, collar, shoulder, elbow, wrist"),
    ("the fourth of three motions", lambda: BATCH[3], "Motion: index 3 in a batch of 3", IndexError),
    ("a motion before the first", lambda: BATCH[-4], "Motion: index -4 in a batch of 3", IndexError),
    ("half an index", lambda: BATCH[1.5], "Motion: an index is a whole number, not 1.5", TypeError),
    ("True for an index", lambda: BATCH[True], "Motion: an index is a whole number, not True", TypeError),
    ("a word for an index", lambda: BATCH["a"], "Motion: an index is a whole number, not 'a'", TypeError),
    ("a slice of a batch", lambda: BATCH[0:2], "Motion: an index is a whole number, not slice(0, 2, None)", TypeError),
    ("a file that is not there", lambda: pf.Motion.load(FOLDER / "nowhere.npz"), "Motion.load: there is no file at …/nowhere.npz", FileNotFoundError),
    ("a file cut short", lambda: pf.Motion.load(damaged("cut.npz", lambda data: data[:200])), "Motion.load: …/cut.npz is not a readable motion file (…)"),
    ("a file with a byte changed", lambda: pf.Motion.load(damaged("changed.npz", lambda data: data[:300] + bytes([data[300] ^ 255]) + data[301:])), "Motion.load: …/changed.npz is not a readable motion file (…)"),
    ("an empty file", lambda: pf.Motion.load(damaged("empty.npz", lambda data: b"")), "Motion.load: …/empty.npz is not a readable motion file (…)"),
    ("a file of text", lambda: pf.Motion.load(damaged("text.npz", lambda data: b"left_wrist 0 1 2")), "Motion.load: …/text.npz is not a readable motion file (…)"),
    ("a file without positions", lambda: pf.Motion.load(archive("noposition.npz", fps=20.0, prompt=np.array([], str))), "Motion.load: …/noposition.npz is not a readable motion file (…)"),
    ("a file whose motion has 21 joints", lambda: pf.Motion.load(archive("joints.npz", positions=np.zeros((4, 21, 3)), fps=20.0, prompt=np.array([], str))), "Motion.load: …/joints.npz is not a readable motion file (Motion: expected shape (..., frames, 22, 3), got (4, 21, 3))"),
    ("a file that holds pickled objects", lambda: pf.Motion.load(archive("objects.npz", positions=np.array([{}], object), fps=20.0, prompt=np.array([], str))), "Motion.load: …/objects.npz is not a readable motion file (…)"),
    ("a folder for a file", lambda: pf.Motion.load(FOLDER), "Motion.load: … is not a readable motion file (…)"),
    ("a number for a path", lambda: pf.Motion.load(3), "Motion.load: 3 is not a readable motion file (…)"),
    # checkpoints
    ("a checkpoint that is not there", lambda: pf.load_prior(FOLDER / "nowhere.safetensors"), "there is no checkpoint at …/nowhere.safetensors", FileNotFoundError),
    ("a checkpoint cut short", lambda: pf.load_prior(checkpoint("cut", lambda data: data[:-1000])), "…/cut.safetensors is damaged or is not a checkpoint (…)"),
    ("a checkpoint without its end of header", lambda: pf.load_prior(checkpoint("header", lambda data: data[:100])), "…/header.safetensors is damaged or is not a checkpoint (…)"),
    ("a checkpoint of eight bytes", lambda: pf.load_prior(checkpoint("eight", lambda data: data[:8])), "…/eight.safetensors is damaged or is not a checkpoint (…)"),
    ("an empty checkpoint", lambda: pf.load_prior(checkpoint("empty", lambda data: b"")), "…/empty.safetensors is damaged or is not a checkpoint (…)"),
    ("a checkpoint with another magic", lambda: pf.load_prior(checkpoint("magic", lambda data: b"PK\x03\x04" + data[4:])), "…/magic.safetensors is damaged or is not a checkpoint (…)"),
    ("a pickle for a checkpoint", lambda: pf.load_prior(checkpoint("pickle", lambda data: pickle.dumps({"a": 1}))), "…/pickle.safetensors is damaged or is not a checkpoint (…)"),
    ("a folder for a checkpoint", lambda: pf.load_prior(FOLDER), "there is no checkpoint at …", FileNotFoundError),
    ("a judge for a prior", lambda: pf.load_prior(EVALUATOR), "load_prior: … is not a projflow_lite prior"),
    ("a prior for a judge", lambda: scores.load_evaluator(SHIPPED), "load_evaluator: … is not a projflow_lite evaluator"),
    ("a checkpoint of another format", lambda: pf.load_prior(with_words("format", {"prior": '{"format": "projflow_lite prior 0"}'})), "load_prior: …/format.safetensors is not a projflow_lite prior"),
    ("a checkpoint without a description", lambda: pf.load_prior(with_words("bare", {})), "load_prior: …/bare.safetensors is not a projflow_lite prior"),
    # scores
    ("errors of two shapes", lambda: scores.control_errors(np.zeros((4, 22, 3)), np.zeros((5, 22, 3))), "control_errors: positions (4, 22, 3) and targets (5, 22, 3) differ"),
    ("errors without a target", lambda: scores.control_errors(np.zeros((4, 22, 3)), np.full((4, 22, 3), np.nan)), "control_errors: a clip has no target at all"),
    ("errors of a motion with NaN", lambda: scores.control_errors(one_value(np.nan), np.zeros((4, 22, 3))), "control_errors: a position is not finite; only targets may be NaN"),
    ("errors in words", lambda: scores.control_errors("a", "b"), "control_errors: positions should be a regular array of numbers, not text"),
    ("errors of a plane", lambda: scores.control_errors(np.zeros((4, 22, 2)), np.zeros((4, 22, 2))), "control_errors: positions (4, 22, 2) are not (..., frames, joints, 3)"),
    ("bones of 21 joints", lambda: scores.bone_length_error(np.zeros((4, 21, 3))), "bone_length_error: expected shape (..., frames, 22, 3), got (4, 21, 3)"),
    ("bones of length zero", lambda: scores.bone_length_error(np.zeros((4, 22, 3))), "bone_length_error: reference is 21 lengths, all above 0"),
    ("bones against 20 lengths", lambda: scores.bone_length_error(X, np.ones(20)), "bone_length_error: reference is 21 lengths, all above 0"),
    ("bones against NaN", lambda: scores.bone_length_error(X, np.full(21, np.nan)), "bone_length_error: reference is 21 lengths, all above 0"),
    ("skating by another definition", lambda: scores.foot_skating(X, definition="omnicontrol"), "foot_skating: definition is 'gmd' or 'bmm', not 'omnicontrol'"),
    ("skating of one frame", lambda: scores.foot_skating(X[:1]), "foot_skating: a motion of one frame has no speed"),
    ("skating at no frames a second", lambda: scores.foot_skating(X, fps=0), "foot_skating: fps is a number above 0, not 0"),
    ("skating at NaN frames a second", lambda: scores.foot_skating(X, fps=np.nan), "foot_skating: fps is a number above 0, not nan"),
    ("the acceleration of two frames", lambda: scores.worst_acceleration(X[:2]), "worst_acceleration: needs at least 3 frames, not 2"),
    ("the jerk of three frames", lambda: scores.mean_jerk(X[:3]), "mean_jerk: needs at least 4 frames, not 3"),
    ("kinetic features of one frame", lambda: scores.kinetic_features(X[:1]), "kinetic_features: needs at least 3 frames, not 1"),
    ("kinetic features of NaN", lambda: scores.kinetic_features(one_value(np.nan)), "kinetic_features: right_knee, frame 2, y is not finite"),
    ("pose features of a word", lambda: scores.pose_features("walk"), "pose_features: positions should be a regular array of numbers, not text"),
    ("a distance of sets of other features", lambda: scores.frechet_distance(np.zeros((9, 3)), np.zeros((9, 4))), "frechet_distance: two sets of at least two feature vectors of one length, not (9, 3) and (9, 4)"),
    ("a distance of one sample", lambda: scores.frechet_distance(np.zeros((1, 3)), np.zeros((9, 3))), "frechet_distance: two sets of at least two feature vectors of one length, not (1, 3) and (9, 3)"),
    ("a distance with NaN", lambda: scores.frechet_distance(np.full((9, 3), np.nan), np.zeros((9, 3))), "frechet_distance: a feature is not finite"),
    ("a distance of words", lambda: scores.frechet_distance("a", "b"), "frechet_distance: features should be a regular array of numbers, not text"),
    ("a ranking of other sets", lambda: scores.r_precision(np.zeros((32, 3)), np.zeros((31, 3))), "r_precision: texts (32, 3) and motions (31, 3) are not (motions, features)"),
    ("a ranking of too few", lambda: scores.r_precision(np.zeros((31, 3)), np.zeros((31, 3))), "r_precision: 31 motions do not fill one batch of 32; give more"),
    ("a ranking among one", lambda: scores.r_precision(np.zeros((32, 3)), np.zeros((32, 3)), batch=1), "r_precision: 32 motions do not fill one batch of 1; give more"),
    ("a ranking with NaN", lambda: scores.r_precision(np.full((32, 3), np.nan), np.zeros((32, 3))), "r_precision: an embedding is not finite"),
    ("a matching of nothing", lambda: scores.matching_score(np.zeros((0, 3)), np.zeros((0, 3))), "matching_score: texts (0, 3) and motions (0, 3) are not (motions, features)"),
    ("a diversity of one motion", lambda: scores.diversity(np.zeros((1, 3))), "diversity: embeddings (at least 2, features) and a pair, not (1, 3) and 300"),
    ("a diversity of no pair", lambda: scores.diversity(np.zeros((9, 3)), pairs=0), "diversity: embeddings (at least 2, features) and a pair, not (9, 3) and 0"),
    ("a diversity with NaN", lambda: scores.diversity(np.full((9, 3), np.nan)), "diversity: an embedding is not finite"),
    ("a diversity of half pairs", lambda: scores.diversity(np.zeros((9, 3)), pairs=2.5), "diversity: pairs is a whole number, not 2.5"),
    ("a multimodality without prompts", lambda: scores.multimodality(np.zeros((9, 3))), "multimodality: embeddings (prompts, at least 2, features) and a pair, not (9, 3) and 10"),
    ("a multimodality with NaN", lambda: scores.multimodality(np.full((2, 9, 3), np.nan)), "multimodality: an embedding is not finite"),
    ("an interval of nothing", lambda: scores.interval([]), "interval: one number for each repetition, not shape (0,)"),
    ("an interval of a table", lambda: scores.interval(np.zeros((2, 2))), "interval: one number for each repetition, not shape (2, 2)"),
    ("an interval with NaN", lambda: scores.interval([1.0, np.nan, 2.0]), "interval: a measurement is not finite"),
    ("an interval of 95 per cent as 95", lambda: scores.interval([1.0, 2.0], confidence=95), "interval: confidence is between 0 and 1, not 95"),
    ("an interval of words", lambda: scores.interval(["a", "b"]), "interval: values should be a regular array of numbers, not text"),
    ("scores of no clip", lambda: scores.score_clips([]), "score_clips: there is no clip"),
    ("scores of batches of clips", lambda: scores.score_clips([np.zeros((2, 60, 22, 3))]), "score_clips: a clip is (frames, 22, 3), not (2, 60, 22, 3)"),
    ("captions for fewer clips", lambda: scores.score_clips(np.zeros((2, 60, 22, 3)), ["a person walks"]), "score_clips: 1 captions for 2 clips"),
    ("clips too short for the judge", lambda: judge().embed_motion(np.zeros((2, 19, 22, 3))), "embed_motion: 19 frames; it takes 20 to 196"),
    ("one caption for a list", lambda: judge().embed_text("a person walks"), "embed_text: captions is a list of texts, one for each motion"),
    ("a caption that says nothing", lambda: judge().embed_text(["!?"]), "evaluator: it knows no word of '!?'"),
    # skeleton
    # synthetic motion
    ("an action misspelt", lambda: make_clips(3, actions=["wlak"]), "make_clips: 'wlak' is not an action; did you mean 'walk'?"),
    ("no action", lambda: make_clips(3, actions=[]), "make_clips: actions is an empty list"),
    ("no clip", lambda: make_clips(0), "make_clips: n is a whole number of at least 1, not 0"),
    ("half a clip", lambda: make_clips(2.5), "make_clips: n is a whole number of at least 1, not 2.5"),
    ("True as a number of clips", lambda: make_clips(True), "make_clips: n is a whole number of at least 1, not True"),
    ("False as a seed of clips", lambda: make_clips(3, seed=False), "make_clips: seed is a whole number from 0 to 2^63 - 1, not False"),
    ("bones of a pose without frames", lambda: skeleton.bone_lengths(np.zeros((22, 3))), "bone_lengths: expected shape (..., frames, 22, 3), got (22, 3)"),
    ("bones of another skeleton", lambda: skeleton.bone_lengths(np.zeros((5, 17, 3))), "bone_lengths: expected shape (..., frames, 22, 3), got (5, 17, 3)"),
    ("a mirror image of another skeleton", lambda: skeleton.mirror(np.zeros((5, 17, 3))), "mirror: expected shape (..., frames, 22, 3), got (5, 17, 3)"),
    ("clips too short", lambda: make_clips(3, frames=19), "make_clips: frames is 20 to 196, not 19"),
    ("clips too long", lambda: make_clips(3, frames=197), "make_clips: frames is 20 to 196, not 197"),
    ("a negative seed of clips", lambda: make_clips(3, seed=-1), "make_clips: seed is a whole number from 0 to 2^63 - 1, not -1"),
    ("a seed of the held-out clips", lambda: make_clips(3, seed=2**64), "make_clips: seed is a whole number from 0 to 2^63 - 1, not 18446744073709551616"),
    # equations
    ("a metric without a ridge", lambda: eq.joint_metric(L, 10.0, 0.0), "joint_metric: w_kin must not be negative and ridge must be positive"),
    ("a metric with a negative weight", lambda: eq.joint_metric(L, -1.0, 1.0), "joint_metric: w_kin must not be negative and ridge must be positive"),
    ("a bone from a joint to itself", lambda: eq.kinematic_laplacian([(0, 0)], 3), "kinematic_adjacency: (0, 0) is no bone among 3 joints"),
    ("a bone to a joint that is not there", lambda: eq.kinematic_laplacian([(0, 3)], 3), "kinematic_adjacency: (0, 3) is no bone among 3 joints"),
    ("half a frame in a metric", lambda: eq.kinematic_metric(2.5, L, 10.0, 1.0), "kinematic_metric: frames is 2.5, expected a whole number from 1 on"),
    ("a motion that was not vectorised", lambda: eq.project(np.zeros((1, 22, 3)), np.eye(1, 66), np.zeros(1), np.eye(66), np.zeros((1, 1))), "project: x1_hat has shape (1, 22, 3); vectorise it first"),
    ("rows that do not fit the motion", lambda: eq.project(np.zeros(66), np.eye(1, 65), np.zeros(1), np.eye(66), np.zeros((1, 1))), "project: A has shape (1, 65), expected (any, 66)"),
    ("targets that do not fit the rows", lambda: eq.project(np.zeros(66), np.eye(1, 66), np.zeros(2), np.eye(66), np.zeros((1, 1))), "project: y has shape (2,), expected (1,)"),
    ("targets as a column, in eq. 7", lambda: eq.project(np.zeros(66), np.eye(1, 66), np.zeros((1, 1)), np.eye(66), np.zeros((1, 1))), "project: y has shape (1, 1), expected (1,)"),
    ("an R that is not symmetric", lambda: eq.project(np.zeros(2), np.eye(1, 2), np.zeros(1), np.array([[1.0, 0.5], [0.0, 1.0]]), np.zeros((1, 1))), "project: R is not symmetric"),
    ("an R that is not positive definite", lambda: eq.project(np.zeros(2), np.eye(1, 2), np.zeros(1), -np.eye(2), np.zeros((1, 1))), "project: R is not positive definite"),
    ("a negative variance, in eq. 7", lambda: eq.project(np.zeros(2), np.eye(1, 2), np.zeros(1), np.eye(2), -np.eye(1)), "project: Sigma has a negative variance (-1)"),
    ("an infinite variance, in eq. 7", lambda: eq.project(np.zeros(2), np.eye(1, 2), np.zeros(1), np.eye(2), np.inf * np.eye(1)), "project: Sigma has a value that is not finite"),
    ("rows that contradict each other, in eq. 7", lambda: eq.project(np.zeros(2), np.ones((2, 2)), np.array([0.0, 1.0]), np.eye(2), np.zeros((2, 2))), "project: rows 0, 1 contradict each other"),
    ("a row of zeros that asks, in eq. 7", lambda: eq.project(np.zeros(2), np.zeros((1, 2)), np.array([1.0]), np.eye(2), np.zeros((1, 1))), "project: row 0 measures nothing, yet asks for a value"),
    ("NaN, in eq. 7", lambda: eq.project(np.array([np.nan, 0]), np.eye(1, 2), np.zeros(1), np.eye(2), np.zeros((1, 1))), "project: x1_hat has a value that is not finite"),
    ("a time above one", lambda: eq.interpolate(np.zeros(2), np.ones(2), 1.5), "interpolate: t = 1.5 is outside 0..1"),
    ("a time of NaN", lambda: eq.interpolate(np.zeros(2), np.ones(2), np.nan), "interpolate: t has a value that is not finite"),
    ("a start and an end of two shapes", lambda: eq.interpolate(np.zeros(2), np.ones((2, 1)), 0.5), "interpolate: the shapes differ: x0 (2,), x1 (2, 1)"),
    ("times for another batch", lambda: eq.interpolate(np.zeros((2, 3)), np.ones((2, 3)), np.array([0.1, 0.2, 0.3])), "interpolate: t has shape (3,); expected a scalar or the leading axes of (2, 3)"),
    ("a loss of nothing", lambda: eq.flow_matching_loss(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 3))), "flow_matching_loss: expected (batch, ...) with at least one sample"),
    ("a share of fresh noise above one", lambda: eq.mix_noise(np.zeros(2), np.zeros(2), 1.5), "mix_noise: eta = 1.5 is outside 0..1"),
    ("radii that are swapped", lambda: eq.halo_radius(0.5, 10, 3), "halo_radius: expected 0 <= l_min <= l_max, got 10 and 3"),
    ("a trust in no frame", lambda: eq.frame_trust(np.zeros(0), 0.5, 3.0, 1.0, 2.0, 0.1), "frame_trust: needs frames; s, c0, lambda_s not negative; p positive"),
    ("a negative curvature", lambda: eq.frame_trust(np.array([-1.0, 1.0]), 0.5, 3.0, 1.0, 2.0, 0.1), "frame_trust: needs frames; s, c0, lambda_s not negative; p positive"),
    ("a trust of zero, in eq. 18", lambda: eq.variance_from_trust(np.zeros(2), np.ones(2)), "variance_from_trust: pi must be in (0, 1], clip it first; r positive"),
    ("a metric of 21 joints, in eq. 17", lambda: eq.curvature(np.zeros((4, 22, 3)), np.eye(21)), "curvature: R_J has shape (21, 21), expected (22, 22)"),
    ("an offset from a joint to itself, in eq. 35", lambda: eq.offset_rows(4, 22, 3, 3, [0, 0, 0]), "offset_rows: joint_a and joint_b are both 3"),
    ("a camera that is no rotation", lambda: eq.orthographic_projection(np.zeros(3), 2 * np.eye(3), 1.0), "orthographic: R_cam is not a rotation"),
    ("a vector that is no motion", lambda: eq.unvectorise(np.zeros(65), 1, 22), "unvectorise: shape (65,) does not end in 3 * 1 * 22"),
    ("dependent rows, in eq. 41", lambda: eq.euclidean_projection(np.zeros(2), np.ones((2, 2)), np.zeros(2)), "euclidean_projection: rows of A are dependent; use ddnm (eq. 21)"),
    ("a form that there is not, in eq. 15", lambda: eq.frame_trust(np.ones(3), 0.5, 3.0, 1.0, 2.0, 0.1, form="corrected"), "frame_trust: form is 'corrected', expected one of printed, released"),
    ("a distance of 3 in 2 sets", lambda: scores.frechet_distance(np.zeros((9, 3)), np.zeros(9)), "frechet_distance: two sets of at least two feature vectors of one length, not (9, 3) and (9,)"),
]  # fmt: skip


@pytest.mark.parametrize("row", WRONG, ids=[name for name, *_ in WRONG])
def test_it_is_refused_in_one_line(row):
    check_refusal(*row[1:])


def test_there_are_two_hundred_and_more():
    names = [name for name, *_ in WRONG_WISHES + WRONG]
    assert len(set(names)) == len(names) >= 400
    messages = {message for _, _, message, *_ in WRONG_WISHES + WRONG}
    assert len(messages) >= 300
