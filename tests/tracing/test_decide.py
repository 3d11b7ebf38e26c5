"""The verdict as a table: evidence in, verdict out, without a record or a simulation."""

import json
from dataclasses import fields, replace

import pytest

from workbench.errors import WorkbenchError
from workbench.residual.window import EITHER, Window
from workbench.tracing.criteria import Criteria
from workbench.tracing.decide import CAUSE, DRESSING, NOT_BORNE_OUT, NOTHING, REFINEMENT, UNKNOWN, decide, in_question
from workbench.tracing.evidence import ADDITION, CORRECTION, Evidence, Explainable, Weighed, evidence_of
from workbench.tracing.output import _plain
from workbench.tracing.unexplained import Unexplained, described

STANDARD = Criteria()


def weighed(effect="cogging", id_=(0.05, 0.01), val=(0.05, 0.01), kind=ADDITION, at="axis", **more) -> Weighed:
    before, after = ({"identification": i, "validation": v} for i, v in zip(id_, val, strict=True))
    return Weighed(effect, at, kind, before, after, **more)


def evidence(*added: Weighed, before=0.03, after=0.0, **more) -> Evidence:
    first = added[0].before if added else {"identification": 0.05, "validation": 0.05}
    floor = {"identification": 1e-3, "validation": 1e-3}
    return Evidence(first, floor, Explainable(exogenous=before), Explainable(exogenous=after), added, **more)


def left_of(identification: float, validation: float, floor: float = 1e-3) -> Evidence:
    """Evidence of a declared model that leaves so much of the drive, of which nothing is foretold."""
    declared = {"identification": identification, "validation": validation}
    return Evidence(declared, dict.fromkeys(declared, floor), Explainable(), Explainable())


CASES = {
    "noise that nothing predicts is nothing missing": (evidence(before=0.0), NOTHING, ()),
    "where it is more than anybody would call noise it is unknown": (left_of(0.18, 0.16), UNKNOWN, ()),
    "as a regulator that hunts leaves": (left_of(0.1095, 0.0816, floor=0.002), UNKNOWN, ()),
    "the worst of 130 complete models leaves less": (left_of(0.062, 0.0595), NOTHING, ()),
    "not where one role has less of it": (left_of(0.18, 0.06), NOTHING, ()),
    "nor where counts alone would leave as much": (left_of(0.184, 0.226, floor=0.09), NOTHING, ()),
    "a supply that sags leaves three floors of a coarsely counted drive, which is more": (left_of(0.1423, 0.1496, floor=0.0456), UNKNOWN, ()),
    "a model that is farther from the validation record than none at all lacks something": (left_of(0.05, 1.05), UNKNOWN, ()),
    "without a validation record it is asked of the one role": (left_of(0.18, float("nan")), UNKNOWN, ()),
    "a near law leaves a little": (evidence(before=0.0044), NOTHING, ()),
    "something that no effect takes is unknown": (evidence(before=0.0143), UNKNOWN, ()),
    "an effect that takes it on validation is the cause": (evidence(weighed()), CAUSE, (CAUSE,)),
    "one that takes 42 % only dresses": (
        evidence(weighed(id_=(0.09, 0.05), val=(0.09, 0.0685)), before=0.08, after=0.06), UNKNOWN, (DRESSING,),
    ),
    "what takes a tenth of the drive is no refinement of what takes most of it": (
        evidence(weighed("constant_offset", (0.92, 0.1415), (1.046, 0.259)), weighed("gravity", (0.1415, 0.0772), (0.259, 0.110))), CAUSE,
        (CAUSE, CAUSE),
    ),
    "a further wave whose phase on validation is that of another power-up is not borne out there": (
        evidence(weighed("viscous_asymmetry", (0.0393, 0.0292), (0.0563, 0.0496)),
            weighed("kinematic_error", (0.0194, 0.018), (0.0276, 0.0257), power_up=True), before=0.034), CAUSE, (CAUSE, NOT_BORNE_OUT),
    ),
    "alone it is a cause, with a phase to be calibrated": (
        evidence(weighed("cogging", (0.05, 0.01), (0.05, 0.01), power_up=True)), CAUSE, (CAUSE,),
    ),
    "a memory of the declared friction that takes less than `beside` of the drive beside a larger cause is a law that is only nearly right": (
        evidence(weighed("torque_constant_saturation", (0.0371, 0.0104), (0.033, 0.0096)),
            weighed("presliding_hysteresis", (0.0104, 0.0038), (0.0096, 0.0032), of_declared=True)), CAUSE, (CAUSE, REFINEMENT),
    ),
    "nor is that friction turning over a speed a cause, though most of the load's balance at rest": (
        evidence(weighed("backlash", (0.0914, 0.0085), (0.1102, 0.0099), at="joint"),
            weighed("nonlinear_viscous_friction", (0.0085, 0.00843), (0.00995, 0.00987), of_declared=True, at="load",
            load_before={"identification": 0.0294, "validation": 0.0916}, load_after={"identification": 0.016, "validation": 0.0406})),
        CAUSE, (CAUSE, REFINEMENT),
    ),
    "what only noise that came back through the loop looks like is not borne out by what is outside it": (
        evidence(weighed("actuator_lag", (0.0366, 0.0201), (0.0341, 0.0179), outside=0.079, outside_error=0.041)), UNKNOWN, (NOT_BORNE_OUT,),
    ),
    "of which nothing else is foretold, so that it is noise": (
        evidence(weighed("actuator_lag", (0.0366, 0.0201), (0.0341, 0.0179), outside=0.079, outside_error=0.041), before=0.0), NOTHING,
        (NOT_BORNE_OUT,),
    ),
    "nor does it refute what shows behind the joint": (
        evidence(weighed("kinematic_error", (0.0366, 0.03), (0.0341, 0.02), outside=0.0, outside_error=0.04,
            load_before={"identification": 0.2, "validation": 0.2}, load_after={"identification": 0.02, "validation": 0.02})), CAUSE, (CAUSE,),
    ),
    "nor what takes nearly all in both roles: of when an axis sticks the reference tells little": (
        evidence(weighed("stribeck_friction", (0.0509, 0.012), (0.041, 0.0061), outside=0.355, outside_error=0.065)), CAUSE, (CAUSE,),
    ),
    "where what is outside says little either way it refutes nothing": (
        evidence(weighed("actuator_lag", (0.0366, 0.0201), (0.0341, 0.0179), outside=0.494, outside_error=0.583)), CAUSE, (CAUSE,),
    ),
    "one that takes more is a cause beside it": (
        evidence(weighed("kinematic_error", (0.16, 0.12), (0.16, 0.11)),
            weighed("fading_memory", (0.12, 0.0150), (0.11, 0.0370), of_declared=True)), CAUSE, (CAUSE, CAUSE),
    ),
    "up to a tenth of the drive it is the declared law that is only nearly right, though it takes most": (
        evidence(weighed("presliding_hysteresis", (0.1094, 0.0668), (0.1714, 0.0787), of_declared=True),
            weighed("kinematic_error", (0.0668, 0.0489), (0.0787, 0.059)), weighed("stribeck_friction", (0.0489, 0.0163), (0.059, 0.0226))), CAUSE,
        (REFINEMENT, CAUSE, CAUSE),
    ),
    "not a gap before the friction, which is another effect": (
        evidence(weighed("kinematic_error", (0.09, 0.0632), (0.09, 0.0503)),
            weighed("backlash", (0.0632, 0.0150), (0.0503, 0.0170), of_declared=True)), CAUSE, (CAUSE, CAUSE),
    ),
    "alone it is missing": (evidence(weighed("presliding_hysteresis", (0.067, 0.0109), (0.054, 0.0116), of_declared=True)), CAUSE, (CAUSE,)),
    "but for what takes less than `beside`": (
        evidence(weighed("presliding_hysteresis", (0.0135, 0.0086), (0.0137, 0.0075), of_declared=True), before=0.001), NOTHING, (REFINEMENT,),
    ),
    "which is nothing missing though all that is foretold is what it takes": (
        evidence(weighed("presliding_hysteresis", (0.0148, 0.0039), (0.0088, 0.0046), of_declared=True), before=0.0101), NOTHING, (REFINEMENT,),
    ),
    "but not where it leaves something that is foretold": (
        evidence(weighed("presliding_hysteresis", (0.0148, 0.0039), (0.0088, 0.0046), of_declared=True), before=0.0135, after=0.012),
        UNKNOWN, (REFINEMENT,),
    ),
    "what takes less than that, and little of what the largest takes, is": (
        evidence(weighed("gravity", (0.92, 0.1), (1.046, 0.11)), weighed("coulomb_asymmetry", (0.1, 0.06), (0.11, 0.07))), CAUSE,
        (CAUSE, REFINEMENT),
    ),
    "what shows in the drive is held against what the largest takes of that, not of the joint's torque": (
        evidence(
            weighed("cubic_stiffness", (0.095, 0.0204), (0.121, 0.0212), load_before={"identification": 0.175, "validation": 0.251},
                load_after={"identification": 0.0046, "validation": 0.0056}),
            weighed("viscous_friction", (0.0204, 0.0057), (0.0212, 0.0069), load_before={"identification": 0.0046, "validation": 0.0056},
                load_after={"identification": 0.0043, "validation": 0.0048}),
        ), CAUSE, (CAUSE, CAUSE),
    ),
    "what shows behind the joint is, too, against what the largest takes there": (
        evidence(
            weighed("cubic_stiffness", (0.095, 0.0204), (0.121, 0.0212), load_before={"identification": 0.175, "validation": 0.251},
                load_after={"identification": 0.0204, "validation": 0.0212}),
            weighed("viscous_friction", (0.0204, 0.02), (0.0212, 0.021), load_before={"identification": 0.0204, "validation": 0.0212},
                load_after={"identification": 0.0057, "validation": 0.0056}),
        ), CAUSE, (CAUSE, REFINEMENT),
    ),
    "little is left where validation excites it little": (
        evidence(weighed(val=(0.05, 0.042)), before=0.02, after=0.002), CAUSE, (CAUSE,),
    ),
    "less than what a stiffness takes that changes along the stroke only dresses it": (
        replace(evidence(weighed("creep", (0.054, 0.0427), (0.16, 0.147))), before=Explainable(exogenous=0.025, joint=0.043)), UNKNOWN,
        (DRESSING,),
    ),
    "less than what an inertia takes that changes along the stroke only dresses it, too": (
        replace(evidence(weighed("kinematic_error", (0.11, 0.03), (0.12, 0.03))), before=Explainable(exogenous=0.1, inertia=0.112)), UNKNOWN,
        (DRESSING,),
    ),
    "what takes as much as an inertia does that changes along the stroke stays the cause, for an eccentric encoder is both": (
        replace(evidence(weighed("encoder_eccentricity", (0.073, 0.005), (0.068, 0.004))), before=Explainable(exogenous=0.07, inertia=0.0735)),
        CAUSE, (CAUSE,),
    ),
    "it is there though the reference foretells nothing of it, and what no machine has takes as much": (
        replace(
            evidence(
                weighed("inertia", (0.23, 0.168), (0.17, 0.143), CORRECTION, changed=0.15, tolerance=0.01),
                weighed("kinematic_error", (0.168, 0.094), (0.143, 0.085), implausible="its order stands on its bound"), before=0.0,
            ),
            before=Explainable(inertia=0.16),
        ), UNKNOWN, (DRESSING, DRESSING),
    ),
    "an eccentricity of degrees that takes as much as an inertia along the stroke stays the cause, too": (
        replace(
            evidence(weighed("encoder_eccentricity", (0.042, 0.007), (0.049, 0.01), implausible="an eccentricity of degrees"), before=0.0),
            before=Explainable(inertia=0.037),
        ), CAUSE, (CAUSE,),
    ),
    "what the declared friction is only nearly right in takes nothing of it: a crank whose Coulomb friction gives way": (
        replace(
            evidence(
                weighed("presliding_hysteresis", (0.0890, 0.0670), (0.1166, 0.0848), of_declared=True),
                weighed("encoder_eccentricity", (0.0670, 0.0496), (0.0848, 0.0696), implausible="an eccentricity of degrees"),
                weighed("inertia", (0.0496, 0.0297), (0.0696, 0.0469), CORRECTION, changed=0.2, tolerance=0.01),
            ),
            before=Explainable(exogenous=0.0512, inertia=0.0636),
        ),
        UNKNOWN, (REFINEMENT, DRESSING, DRESSING),
    ),
    "a memory that is most of everything is no near law, and takes what such an inertia would: a contact that is no drive": (
        replace(
            evidence(weighed("presliding_length", (0.61, 0.05), (0.60, 0.053), of_declared=True), before=0.44), before=Explainable(exogenous=0.44, inertia=0.29)
        ),
        CAUSE, (CAUSE,),
    ),
    "one of ten degrees that takes hardly more than it dresses it: an arm whose inertia changes": (
        replace(
            evidence(weighed("encoder_eccentricity", (0.0659, 0.0262), (0.0633, 0.0294), implausible="an eccentricity of degrees"), before=0.0),
            before=Explainable(exogenous=0.0561, inertia=0.0594),
        ), UNKNOWN, (DRESSING,),
    ),
    "an inertia that changes along the stroke is no sixth kind of what is explainable": (
        replace(evidence(), before=Explainable(exogenous=0.004, inertia=0.02)), NOTHING, (),
    ),
    "but where it is most of what the declared model leaves something is missing, whatever the reference foretells: a bell crank": (
        replace(left_of(0.0282, 0.0747), before=Explainable(exogenous=0.0059, inertia=0.0259)), UNKNOWN, (),
    ),
    "so it is with a drive's gain that changes in bench time": (
        replace(left_of(0.0282, 0.0747), before=Explainable(exogenous=0.0059, gain=0.0219)), UNKNOWN, (),
    ),
    "a data sheet's mass beside which such a gain stays is the mean of it: a coil that warms up": (
        replace(
            evidence(weighed("inertia", (0.0937, 0.0482), (0.0974, 0.0469), CORRECTION, changed=0.079, tolerance=0.01), before=0.0105),
            after=Explainable(gain=0.0446),
        ), UNKNOWN, (DRESSING,),
    ),
    "an amplifier that folds its current back is two such masses and a drift": (
        replace(
            evidence(weighed("inertia", (0.0901, 0.0726), (0.0923, 0.0632), CORRECTION, changed=0.132, tolerance=0.01),
                weighed("inertia", (0.0726, 0.0669), (0.0632, 0.0604), CORRECTION, changed=0.113, tolerance=0.01),
                weighed("friction_drift", (0.0669, 0.061), (0.0604, 0.0555)), before=0.053),
            after=Explainable(time=0.0424, gain=0.0448),
        ), UNKNOWN, (DRESSING, DRESSING, DRESSING),
    ),
    "magnets that warm up are two masses, though the gain takes less than half of what they leave": (
        replace(
            evidence(weighed("inertia", (0.0767, 0.0674), (0.0548, 0.0329), CORRECTION, changed=0.073, tolerance=0.01),
                weighed("inertia", (0.0674, 0.0585), (0.0329, 0.0259), CORRECTION, changed=0.068, tolerance=0.01), before=0.0084),
            after=Explainable(exogenous=0.0148, time=0.0165, gain=0.0365),
        ), UNKNOWN, (DRESSING, DRESSING),
    ),
    "a driver that folds its current back is a mass that swings and a spring, which take half of such a gain": (
        replace(
            evidence(weighed("flexible_mode", (0.1069, 0.0516), (0.1034, 0.0752)), weighed("linear_stiffness", (0.0516, 0.045), (0.0752, 0.0542))),
            before=Explainable(exogenous=0.0379, time=0.0419, gain=0.0597), after=Explainable(time=0.0212, burst=0.0147, gain=0.0317),
        ), UNKNOWN, (DRESSING, DRESSING),
    ),
    "of a peak of friction, which is such a gain, too, little of it stays": (
        replace(evidence(weighed("stribeck_friction", (0.0676, 0.015), (0.068, 0.016))),
            before=Explainable(exogenous=0.063, gain=0.0661), after=Explainable(time=0.005, gain=0.0064)), CAUSE, (CAUSE,),
    ),
    "a coil that leaves its gap is two springs and a saturation, of whose rest a constant that changes along the stroke takes most": (
        replace(
            evidence(weighed("piecewise_stiffness", (0.0998, 0.0778), (0.069, 0.06)), weighed("torque_constant_saturation", (0.0778, 0.0589), (0.06, 0.055))),
            before=Explainable(exogenous=0.0288, inertia=0.0579), after=Explainable(exogenous=0.018, inertia=0.0458),
        ), UNKNOWN, (DRESSING, DRESSING),
    ),
    "beside a cause that leaves more than that, it is not all": (
        replace(evidence(weighed("cogging", (0.2, 0.08), (0.2, 0.08))), after=Explainable(inertia=0.0458)), CAUSE, (CAUSE,),
    ),
    "a curve that is any law of its class leaves nothing to a law: what stays lives in places": (
        evidence(
            weighed("cyclic_friction", (0.1192, 0.1080), (0.1716, 0.1554)),
            weighed("cogging", (0.1080, 0.0918), (0.1554, 0.1298), law="free form"), before=0.1163, after=0.0572,
        ), UNKNOWN, (DRESSING, DRESSING),
    ),
    "one beside which nothing stays is the cause": (
        evidence(weighed("cubic_stiffness", (0.10, 0.055), (0.14, 0.04), law="free form"), before=0.078), CAUSE, (CAUSE,),
    ),
    "more than that is a cause": (
        replace(evidence(weighed("backlash", (0.054, 0.02), (0.16, 0.05))), before=Explainable(exogenous=0.025, joint=0.043)), CAUSE,
        (CAUSE,),
    ),
    "what an injected torque alone shows is no less a cause": (
        evidence(weighed("transport_delay", (0.0375, 0.0089), (0.0134, 0.0125)), before=0.0025), CAUSE, (CAUSE,),
    ),
    "less than half in either role, that leaves more beyond noise than it takes, dresses something: grease squeezed out at rest is no Stribeck peak": (
        replace(
            evidence(weighed("stribeck_friction", (0.0867, 0.0683), (0.0959, 0.0728)), before=0.0422, after=0.0177),
            floor={"identification": 0.0027, "validation": 0.0042},
        ), UNKNOWN, (DRESSING,),
    ),
    "a correction within its tolerance is a refinement": (
        evidence(weighed("inertia", kind=CORRECTION, changed=0.009, tolerance=0.01), before=0.0), NOTHING, (REFINEMENT,),
    ),
    "what leaves a little more on identification is no cause, and none leads": (
        evidence(weighed(id_=(0.010, 0.0101), val=(0.020, 0.019)), before=0.0), NOTHING, (REFINEMENT,),
    ),
    "beyond it the value is wrong": (
        evidence(weighed("inertia", kind=CORRECTION, changed=0.15, tolerance=0.01)), CAUSE, (CAUSE,),
    ),
    "a value hardly beyond its tolerance is one, as what is beyond takes nothing of practical size": (
        evidence(weighed("inertia", (0.0214, 0.0165), (0.03, 0.029), CORRECTION, changed=0.0119, tolerance=0.01)), UNKNOWN,
        (REFINEMENT,),
    ),
    "nor is one that a drive's gain, known no better, would make of a value within it": (
        evidence(weighed(id_=(0.155, 0.03), val=(0.155, 0.058)), weighed("inertia", (0.0296, 0.0256), (0.058, 0.056), CORRECTION, changed=0.0172, tolerance=0.01)),
        CAUSE, (CAUSE, REFINEMENT),
    ),
    "less than half a per cent of the drive is a refinement": (
        evidence(weighed(), weighed("lugre_friction", (0.010, 0.0095), (0.010, 0.0095))), CAUSE, (CAUSE, REFINEMENT),
    ),
    "a further effect that takes a tenth of what the largest takes only makes up for its law": (
        evidence(weighed(id_=(0.2, 0.04), val=(0.2, 0.04)), weighed("sensor_trend", (0.04, 0.0346), (0.04, 0.0346))), CAUSE,
        (CAUSE, REFINEMENT),
    ),
    "a further effect that takes a fifth of it is a cause": (
        evidence(weighed(id_=(0.2, 0.04), val=(0.2, 0.04)), weighed("sensor_trend", (0.04, 0.008), (0.04, 0.008))), CAUSE, (CAUSE, CAUSE),
    ),
    "of a bearing behind the joint that nobody counted, which the drive does not show, a hundredth of the joint's torque is no cause": (
        evidence(weighed("coulomb_friction", (0.00807, 0.00785), (0.00923, 0.00901), at="load",
            load_before={"identification": 0.0153, "validation": 0.0198}, load_after={"identification": 0.0033, "validation": 0.0038}), before=0.0),
        NOTHING, (REFINEMENT,),
    ),
    "beside a gap neither": (
        evidence(weighed("backlash", (0.0615, 0.0069), (0.0811, 0.009), at="joint",
            load_before={"identification": 0.0843, "validation": 0.1056}, load_after={"identification": 0.0194, "validation": 0.0258}),
            weighed("coulomb_friction", (0.0069, 0.0067), (0.009, 0.009), at="load",
            load_before={"identification": 0.0194, "validation": 0.0258}, load_after={"identification": 0.0026, "validation": 0.0045})),
        CAUSE, (CAUSE, REFINEMENT),
    ),
    "where the drive shows as much it is a cause": (
        evidence(weighed("coulomb_friction", (0.0153, 0.0033), (0.0198, 0.0038), at="load",
            load_before={"identification": 0.0153, "validation": 0.0198}, load_after={"identification": 0.0026, "validation": 0.003})),
        CAUSE, (CAUSE,),
    ),
    "a mass that is hardly off, and took the most of a drive that saturates before that was there, is a refinement": (
        evidence(weighed("inertia", (0.1125, 0.0874), (0.1137, 0.0828), kind=CORRECTION, changed=0.0265, tolerance=0.01, beside_others=0.0106),
            weighed("torque_constant_saturation", (0.0874, 0.0108), (0.0828, 0.009))), CAUSE, (REFINEMENT, CAUSE),
    ),
    "one that is off by a fifth is wrong beside it, too": (
        evidence(weighed("inertia", (0.1125, 0.0874), (0.1137, 0.0828), kind=CORRECTION, changed=0.2, tolerance=0.01, beside_others=0.0469),
            weighed("torque_constant_saturation", (0.0874, 0.0108), (0.0828, 0.009))), CAUSE, (CAUSE, CAUSE),
    ),
    "a further effect that no machine has, and takes no more than may stay beside a cause": (
        evidence(
            weighed("actuator_lag", (0.1475, 0.0195), (0.16, 0.012)),
            weighed("flexible_mode", (0.0195, 0.0148), (0.0123, 0.0094), implausible="its damping ratio stands on its bound"),
        ), CAUSE, (CAUSE, REFINEMENT),
    ),
    "what makes validation worse is not borne out": (
        evidence(weighed(), weighed("creep", (0.03, 0.01), (0.01, 0.012))), CAUSE, (CAUSE, NOT_BORNE_OUT),
    ),
    "a little that no machine has is a refinement": (
        evidence(weighed(), weighed("kinematic_error", (0.025, 0.024), (0.034, 0.033), implausible="its order stands on its bound")),
        CAUSE, (CAUSE, REFINEMENT),
    ),
    "what takes most of the identification records is no noise, though validation does not bear it out": (
        evidence(weighed(id_=(0.074, 0.042), val=(0.15, 0.78)), before=0.0), UNKNOWN, (NOT_BORNE_OUT,),
    ),
    "but what takes most of a load's small balance, and little of the drive, is a matter of what it does at standstill": (
        evidence(
            weighed(
                "stribeck_friction", (0.022, 0.0156), (0.0203, 0.0179),
                load_before={"identification": 0.203, "validation": 0.108}, load_after={"identification": 0.136, "validation": 0.132},
            ), before=0.0065,
        ), NOTHING, (NOT_BORNE_OUT,),
    ),
    "a declared friction behind the joint is only nearly right where the drive shows little of its memory": (
        evidence(
            weighed("piecewise_stiffness", (0.085, 0.0113), (0.069, 0.0078)),
            weighed(
                "fading_memory", (0.0115, 0.0113), (0.008, 0.0077), of_declared=True,
                load_before={"identification": 0.047, "validation": 0.032}, load_after={"identification": 0.029, "validation": 0.018},
            ),
        ), CAUSE, (CAUSE, REFINEMENT),
    ),
    "and where slow records alone show it": (
        evidence(weighed("presliding_hysteresis", (0.01298, 0.0081), (0.0093, 0.0082), of_declared=True), before=0.004), NOTHING, (REFINEMENT,),
    ),
    "where the drive shows it, its memory is missing": (
        evidence(
            weighed(
                "presliding_hysteresis", (0.117, 0.0108), (0.123, 0.0095), of_declared=True,
                load_before={"identification": 0.56, "validation": 0.57}, load_after={"identification": 0.016, "validation": 0.015},
            ),
        ), CAUSE, (CAUSE,),
    ),
    "where nothing is explainable validation alone decides of what it chose": (
        evidence(weighed("torque_constant_saturation", (0.06, 0.049), (0.11, 0.066), chosen=True), before=0.004), CAUSE, (CAUSE,),
    ),
    "not of what a declared friction is only nearly right in": (
        evidence(weighed("nonlinear_viscous_friction", (0.0198, 0.0154), (0.017, 0.0105)), before=0.0088), NOTHING, (DRESSING,),
    ),
    "one that leaves the level as it was only dresses": (
        replace(
            evidence(weighed("sensor_trend", (0.0382, 0.0277), (0.0175, 0.0170))), before=Explainable(level=0.0174),
            after=Explainable(level=0.0132),
        ), NOTHING, (DRESSING,),
    ),
    "one place that says more than the effects": (
        evidence(weighed(), before=0.05, after=0.04, place_instead=True), UNKNOWN, (DRESSING,),
    ),
    "what is paid for with residual outside a window of the stroke": (
        evidence(weighed(), before=0.07, after=0.03, traded=True), UNKNOWN, (DRESSING,),
    ),
    "three effects that leave a hundredth are causes, though they take three quarters: a screw's friction, measured (EMPS)": (
        evidence(weighed("viscous_asymmetry", (0.0393, 0.0292), (0.0563, 0.0496)), weighed("actuator_lag", (0.0292, 0.0275), (0.0496, 0.0396)),
            weighed("film_friction", (0.0275, 0.0195), (0.0396, 0.0272)), before=0.0341, after=0.0139), CAUSE, (CAUSE, CAUSE, CAUSE),
    ),
    "a rail of two joints is no weight beside a friction over place": (
        evidence(weighed("cyclic_friction", (0.2298, 0.1941), (0.147, 0.1042)), weighed("gravity", (0.1941, 0.1192), (0.1042, 0.0574)),
            before=0.1845, after=0.0598), UNKNOWN, (DRESSING, DRESSING),
    ),
    "what takes nearly all in both roles is a cause, though nearly two hundredths of the drive stay: a servo's weight": (
        replace(evidence(weighed("gravity", (0.7662, 0.2481), (0.8811, 0.3283)), weighed("cyclic_friction", (0.2481, 0.2408), (0.3283, 0.3267))),
            before=Explainable(), after=Explainable(time=0.0181)), CAUSE, (CAUSE, REFINEMENT),
    ),
    "a large cogging that is right leaves a hundredth of what could be explained to the friction that turns over a little speed": (
        evidence(weighed("cogging", (0.1678, 0.0859), (0.1678, 0.0859)), before=0.1381, after=0.0151), CAUSE, (CAUSE,),
    ),
    "what takes a tenth of the residual and hardly anything of what could be explained is no answer": (
        evidence(weighed("cogging", (0.05, 0.0475), (0.05, 0.0475)), before=0.0108, after=0.0095), UNKNOWN, (DRESSING,),
    ),
    "and though more stays: an actuator's gap (BRFD)": (
        evidence(weighed("backlash", (0.7038, 0.1061), (0.7485, 0.1419)), before=0.3649, after=0.0484), CAUSE, (CAUSE,),
    ),
    "what a gain that changes leaves beside half of it is no cause": (
        replace(evidence(weighed("cogging", (0.0937, 0.0482), (0.0974, 0.0469)), before=0.0105), after=Explainable(gain=0.0446)), UNKNOWN,
        (DRESSING,),
    ),
    "a place that says more is no law of the whole stroke": (
        evidence(weighed("fading_memory", (0.2668, 0.1657), (0.3134, 0.09)), before=0.0, place_instead=True), UNKNOWN, (DRESSING,),
    ),
    "a friction that drifts is all of what bench time foretells": (
        replace(evidence(weighed("friction_drift", (0.0666, 0.0486), (0.0801, 0.0535))), before=Explainable(time=0.0577),
            after=Explainable(time=0.0201)), UNKNOWN, (DRESSING,),
    ),
    "one that leaves little of it is a cause": (
        replace(evidence(weighed("friction_drift", (0.0837, 0.0167), (0.1428, 0.0192))), before=Explainable(time=0.0328),
            after=Explainable(time=0.0032)), CAUSE, (CAUSE,),
    ),
    "beside what takes more it says nothing of that": (
        replace(evidence(weighed("cable_spring", (0.1435, 0.06), (0.2522, 0.06)), weighed("friction_drift", (0.06, 0.03), (0.06, 0.03))),
            before=Explainable(time=0.1), after=Explainable(time=0.012)), CAUSE, (CAUSE, CAUSE),
    ),
    "little is left, but a line as it was": (
        replace(
            evidence(weighed(val=(0.05, 0.046))), before=Explainable(line=0.028, burst=0.068), after=Explainable(line=0.026, burst=0.027)
        ), UNKNOWN, (DRESSING,),
    ),
    "an encoder that loses counts, which were put back": (evidence(before=0.0, lost=0.03), UNKNOWN, ()),
    "what is less than the lost counts may dress what is left of them": (
        evidence(weighed(id_=(0.02, 0.01)), lost=0.03), UNKNOWN, (DRESSING,),
    ),
    "what takes more than the lost counts is a cause": (evidence(weighed(), lost=0.03), CAUSE, (CAUSE,)),
    "lost counts that take less than could be explained": (evidence(before=0.0, lost=0.004), NOTHING, ()),
    "a clock that the angle says is late needs no torque": (evidence(before=0.0, clock=True), CAUSE, ()),
    "beside it what takes less than the practical size of validation is a further effect's remainder": (
        evidence(weighed("kinematic_error", (0.0176, 0.0172), (0.0103, 0.0108), load_before={"identification": 0.0093, "validation": 0.0059},
            load_after={"identification": 0.0050, "validation": 0.0038}), clock=True), CAUSE, (REFINEMENT,),
    ),
    "what takes more is a second cause": (evidence(weighed("stribeck_friction"), clock=True), CAUSE, (CAUSE,)),
    "a friction at the motor enters no balance of the load, which bears it out all the same": (
        evidence(
            replace(
                weighed(
                    "friction_drift", (0.085, 0.076), (0.069, 0.071),
                    load_before={"identification": 0.0084, "validation": 0.0143},
                    load_after={"identification": 0.0063, "validation": 0.0100},
                ),
                at="motor",
            ),
            before=0.0,
        ),
        NOTHING, (NOT_BORNE_OUT,),
    ),
    "what shows behind the joint alone": (
        evidence(
            weighed(
                "presliding_hysteresis", (0.01, 0.01), (0.01, 0.01),
                load_before={"identification": 0.1, "validation": 0.1},
                load_after={"identification": 0.03, "validation": 0.04},
            ),
            before=0.0,
        ),
        CAUSE, (CAUSE,),
    ),
    "unless the drive keeps a tenth, as beside an amplifier's dead time": (
        evidence(
            weighed(
                "inertia", (0.1728, 0.1655), (0.1611, 0.1504), CORRECTION, "load", changed=0.152, tolerance=0.01,
                load_before={"identification": 0.098, "validation": 0.0986},
                load_after={"identification": 0.0131, "validation": 0.0151},
            ),
            weighed("piecewise_stiffness", (0.1655, 0.1471), (0.1504, 0.1209), at="joint"),
            before=0.0562, after=0.032,
        ),
        UNKNOWN, (DRESSING, DRESSING),
    ),
    "a further one that takes less than half of what the larger one leaves is none where nothing foretells that": (
        evidence(weighed(id_=(0.2, 0.05), val=(0.2, 0.05)), weighed("flexible_mode", (0.05, 0.038), (0.05, 0.04), foretold=0.0)), CAUSE,
        (CAUSE, REFINEMENT),
    ),
    "it is one where something does": (
        evidence(weighed(id_=(0.2, 0.05), val=(0.2, 0.05)), weighed("flexible_mode", (0.05, 0.038), (0.05, 0.04), foretold=0.02)), CAUSE,
        (CAUSE, CAUSE),
    ),
    "but one that leaves more than half of what could be explained only dresses it": (
        evidence(weighed(id_=(0.2, 0.11), val=(0.18, 0.14)), before=0.11, after=0.08), UNKNOWN, (DRESSING,),
    ),
    "and so does one that takes less than half of identification": (
        evidence(weighed(id_=(0.2, 0.15), val=(0.18, 0.14)), before=0.11, after=0.07), UNKNOWN, (DRESSING,),
    ),
    "what takes half of validation and a quarter of identification is no answer: a drive whose constant goes with the electrical angle": (
        evidence(weighed("cyclic_friction", (0.0687, 0.0593), (0.0786, 0.0539)), before=0.0156, after=0.0115), UNKNOWN, (DRESSING,),
    ),
    "without a validation record the identification records decide": (
        evidence(weighed(val=(float("nan"), float("nan")))), CAUSE, (CAUSE,),
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_a_verdict_follows_from_its_evidence(case):
    given, verdict, roles = CASES[case]
    found = decide(given, STANDARD)
    assert (found.verdict, found.roles) == (verdict, roles)


def test_what_takes_most_of_the_drive_comes_before_what_takes_most_of_a_small_balance_of_the_load():
    gap = weighed("backlash", (0.08, 0.01), (0.08, 0.01))
    contact = weighed(
        "fading_memory", (0.024, 0.008), (0.024, 0.008),
        load_before={"identification": 0.23, "validation": 0.22},
        load_after={"identification": 0.02, "validation": 0.02},
    )  # fmt: skip
    assert contact.size("identification") > gap.size("identification")
    assert decide(evidence(gap, contact), STANDARD).added == ("backlash", "fading_memory")


def test_more_than_the_causes_take_is_something_else():
    assert decide(evidence(weighed(), before=0.05, after=0.03), STANDARD).something_else
    assert not decide(evidence(weighed(), before=0.05, after=0.016), STANDARD).something_else


def test_an_error_below_the_floor_is_an_alarm():
    found = decide(replace(evidence(weighed()), floor={"identification": 0.02, "validation": 0.02}), STANDARD)
    assert found.alarms == ("below floor",) and decide(evidence(weighed()), STANDARD).alarms == ()


def test_evidence_that_was_written_decides_again():
    given = evidence(weighed(), weighed("creep", (0.03, 0.01), (0.01, 0.012)))
    assert decide(evidence_of(given.as_dict()), STANDARD) == decide(given, STANDARD)
    one_role = evidence(
        weighed(val=(float("nan"), float("nan"))), weighed("creep", (0.03, 0.01), (float("nan"), float("nan")))
    )
    written = json.loads(json.dumps(_plain(one_role.as_dict()), allow_nan=False))  # as trace.json holds it
    assert decide(evidence_of(written), STANDARD) == decide(one_role, STANDARD)
    written["added"][0]["of_an_earlier_version"] = True
    assert decide(evidence_of(written), STANDARD) == decide(one_role, STANDARD)


def test_what_is_foretold_is_asked_of_further_causes_alone_that_take_little_of_the_drive():
    largest = weighed(id_=(0.2, 0.05), val=(0.2, 0.05))
    little = weighed("flexible_mode", (0.05, 0.038), (0.05, 0.04))
    much = weighed("gravity", (0.05, 0.03), (0.05, 0.045))
    shows_behind = weighed("creep", (0.05, 0.04), (0.05, 0.042), load_before=little.before, load_after=little.after)
    for further, asked in ((little, [1]), (much, []), (shows_behind, [])):
        assert in_question((largest, further), STANDARD) == asked


def test_what_came_before_the_larger_one_is_held_against_what_that_leaves():
    ripple = weighed(id_=(0.101, 0.0858), val=(0.1297, 0.1021))
    larger = weighed("coulomb_asymmetry", (0.0858, 0.0167), (0.1021, 0.0156))
    assert ripple.share("identification") < 0.3 < 0.9 < ripple.share("identification", (larger,)) <= 1.0
    assert in_question((ripple, larger), STANDARD) == []
    grows = weighed(id_=(0.1, 0.12), val=(0.1, 0.12))
    assert grows.share("identification", (larger,)) == grows.share("identification") < 0.0


def test_where_nothing_outside_a_place_is_left_to_compare_with_trace_json_holds_no_infinite_number():
    place = Window("time", ((1.0, 1.2),), EITHER, 0.9, 0.1, 3.0, outside=float("inf"))
    told = described(Unexplained(place, 3.0), evidence())
    assert "times_calm_outside" not in told and told["coordinate"] == "time"
    known = described(Unexplained(replace(place, outside=1.1), 3.0), evidence())
    assert (known["times_calm"], known["times_calm_outside"]) == (3.0, 1.1)


def test_any_least_explainable_share_from_half_to_1_4_per_cent_decides_alike():
    """Complete models leave 0.44 % of the drive at most, unknown causes 1.43 % and more."""
    for least in (0.005, 0.007, 0.01, 0.014):
        criteria = replace(STANDARD, explainable=least)
        assert decide(evidence(before=0.0044), criteria).verdict == NOTHING
        assert decide(evidence(before=0.0143), criteria).verdict == UNKNOWN


def test_a_criterion_outside_its_range_is_refused():
    for f in fields(Criteria):
        with pytest.raises(WorkbenchError, match=f.name):
            replace(STANDARD, **{f.name: -1.0})
    with pytest.raises(WorkbenchError, match="at most 1"):
        replace(STANDARD, held=1.5)


def test_every_criterion_says_what_halving_and_doubling_does():
    for f in fields(Criteria):
        assert f"    {f.name}: " in Criteria.__doc__


def test_a_free_form_is_found_in_the_plant_by_its_own_name_and_named_by_its_class():
    from workbench.tracing.result import Cause

    formula = Cause("stribeck_friction", "axis", "", (), 0.9, 0.9)
    free = replace(formula, law="free form", form="friction_over_speed")
    assert (formula.key, free.key) == ("stribeck_friction@axis", "friction_over_speed@axis")


def test_a_refinement_is_not_said_to_be_missing():
    from workbench.tracing.result import Cause
    from workbench.tracing.wording import refinement

    found = refinement(Cause("fading_memory", "axis", "Fading memory is missing.", (), 0.004, 0.002, size=0.003))
    assert "missing" not in found.sentence and "0.3 %" in found.sentence


def test_the_cause_that_takes_most_comes_first():
    small, large = weighed("cogging", (0.05, 0.04), (0.05, 0.04)), weighed("backlash", (0.04, 0.005), (0.04, 0.005))
    assert decide(evidence(small, large), STANDARD).ranked == ("backlash", "cogging")
