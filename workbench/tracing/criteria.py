"""What decides a verdict: every number, with its unit, its reason, and what halving and doubling it does.

All sizes are rms of what is explained over rms of the drive, both behind the evaluation filter: a share of the drive that an
engineer can hold against the accuracy that the axis needs. Numerical tolerances of searches are private to their modules.
"""

from dataclasses import asdict, dataclass

from workbench.errors import WorkbenchError


@dataclass(frozen=True)
class Criteria:
    """Criteria of a trace; an argument of `trace`, written into trace.json. Raises WorkbenchError for a value outside its range.

    practical: share of the drive's rms that an effect must take away to be a cause; less is a refinement. The laws of the
        catalogue are right to about that much on a bench; causes that were known took 1.4 % and more. Halved, near laws are
        named as causes; doubled, causes of 1 % are refinements.
    lesser: share of what the largest cause takes away, in rms and of the balance (drive, joint) in which a further one shows, below
        which that is a refinement: a law of the
        catalogue is right to some per cent of what it takes, and something is always found for the rest. On 400 axes of other authors two
        dozen second causes took 0.22 and more, and of 20 effects that nobody put there eleven took 0.076 to 0.136; of 38 pairs that a rig
        draws two take less. Of 816 campaigns and axes, halved, fifteen effects that nobody put there are causes; doubled, fourteen right ones are refinements.
    explainable: share of the drive's rms, predictable from outside the loop, from which something is missing. Complete models
        left up to 0.44 %, unknown causes 1.4 % and more. Halved, four of the complete models of 816 campaigns and axes lack something; doubled, three weak unknown causes are "nothing is missing".
        Also what an effect with values that no machine has (a wave as long as the travel) takes away at least, to be a
        cause nevertheless; and what is left at least, beside what was found, for spellings of every law to be asked: halved or doubled
        there alone, of 77 campaigns and axes none changes.
    beside: share of the drive's rms that stays explainable beside causes, from which something else is said to be missing, and causes that took less than
        `near` of the residual only dress it: of 895 campaigns and axes 25 dressings left as much; of right answers that took less than that EMPS' friction left most, 0.014. Also what a
        memory of the friction that is declared takes at least, to be a cause: of three complete models it took 0.009, 0.010 and 0.056 of the drive, of two
        that lack it 0.12 and 0.18. And share of the joint's torque from which what the load's balance alone shows is a cause: of four frictions behind a joint that nobody counted
        0.013 to 0.028. Of the 895, halved, three of these are causes, and a memory or a law of the declared friction on five more; doubled, five dressings are causes, and one of
        the four frictions is none, rightly.
    held: share of the residual power, of validation and of identification, that the causes must take away. Of validation right ones took 0.68 and more, what
        only dressed an unknown cause up to 0.42. Of identification right ones took 0.71 and more, one that nobody put there 0.26. Of 816 campaigns and axes, halved, five
        complete models lack something; doubled, thirty right causes are none. Also the share of what
        an effect takes that what is outside the loop must bear out: of 186 additions on 117 axes it is 0.82 and more of every right one of which it
        is certain by `alike`, and 0.08, 0.28 and -0.5 of three that nobody put there. Halved, the first alone is refused; doubled, right ones are.
        And the share of what the declared model leaves that an inertia along the stroke, or a gain in bench time, takes, to
        be what is missing: 0.78 and more where it is, 0.40 at most elsewhere. Halved, the same; doubled, a bell crank is "nothing".
        And the share of what validation leaves that another law of its class takes, to stand in the place of one that validation carries: a weight took
        0.53 of what a spring leaves, no other formula more than 0.17. Halved, the same; doubled, the weight is a spring.
    whole: share of the drive's rms that may stay beyond what noise may leave, in every role, though nothing foretells it: a declared model that
        leaves more is not whole. Of 130 complete models of other authors the worst left 0.059; what acts in bench time alone (a piece that is
        carried at times, a neighbour's friction, a regulator that hunts) 0.081, 0.084 and 0.088. Of 255 campaigns and
        axes, halved, a complete one whose loop is disturbed (d09) is "unknown"; doubled, three unknown causes are "nothing is missing".
    unaccounted: the same beside causes that take less than `held`: a model that leaves more has none. What acts in bench time alone (a wind, a
        flow that nobody logged) left 0.16 to 0.46, a cart whose bridge lets it coast 0.15; halved or doubled, of 255 campaigns and axes none
        loses or gains a verdict by it. Also what a further effect takes at
        most to be a refinement of the largest cause: gravity beside the offset of a robot's arm took 0.12, and is that offset doubled. And what a
        memory of the friction that is declared takes at most beside another cause, to be what that law is only nearly right in: of twenty that four
        authors left in their Coulomb friction, of 7 to 100 counts, 0.007 to 0.087, of one that was missing 0.06. Halved, five of the twenty are causes.
        And what a drive keeps, from which no cause that shows behind its joint is the answer: beside an amplifier's dead time 0.12. On 1124 verdicts, halved
        the same; doubled, that one is a joint's stiffness.
        And the memory of LuGre friction beside its peak in the place of dry friction, which is named after the peak: 0.006 and 0.017 of two
        axes, the same halved or doubled.
    share: share of the residual's power that an effect must take away on held-out blocks. Halved, chance correlations with
        in-loop noise are tried more often (and refused later); doubled, second causes are lost.
    certain: standard errors over blocks by which that gain must differ from zero.
    alike: standard errors within which two effects explain the same, so that the simpler stays.
    plain: share of the residual's power that an effect must take away near the noise floor.
    hint: standard errors of a gain that is taken provisionally while another effect is still missing.
    carried: share of its identification gain that an effect must take away on validation to be borne out there. Halved, what
        fits noise is kept; doubled, causes that the validation record excites little are withheld.
    doubted: the same share, below which a finding says that validation does not carry a cause, and another law of its class is asked
        of what takes most. Halved, a joint of two springs stays where a cubic one is; doubled, every cause is asked again.
    tolerance: relative error of a fixed value, where the campaign states none; a correction within it is a refinement, and what counts of
        another one is what it takes beyond twice as much, since a drive's gain is known no better.
    near: share of what a free-form law takes, from which a law of the catalogue says it as well. Halved, a wrong formula of the
        class is named; doubled (1.0 at most), only exact laws are. And share of the residual of both roles that causes take beside which `beside` stays: BRFD's
        gap took 0.96, dressings 0.74 at most. Of 895 campaigns and axes, halved, seven dressings are causes; doubled, that gap is none. And share of what an effect of values that no machine has takes, from which an
        inertia that changes along the stroke is it: of an arm 0.88, of a disc that is eccentric 0.74. Halved, that disc is one; doubled, the arm is a disc.
        And share of the residual in both roles from which nothing outside the loop refutes what takes it: a pulsation that came back as a lag
        took 0.70 and 0.72, Stribeck's peaks of four axes that stick, of which the reference tells 0.36 to 0.52, took 0.88 to 0.98. Halved,
        that lag is a cause; doubled, one of the peaks is not borne out.
    neutral: relative distance within which a parameter stands at the value of a simpler law, which is then the better answer. Halved, a gap
        with soft flanks is two springs; doubled, friction that grows with the load is given away for less (d19).
    resembles: share of what a free-form law takes, that the nearest formula must take for the free form to bear its name. Halved,
        friction in a window is called cyclic; doubled, it is `near`.
    line: power of a spectral line over the median about it, from which it is one. White noise of 1e5 samples reaches 20.
    burst: robust standard deviations from which a sample is part of a burst.
    steps: effects added at most.
    rate: kept rate of the records that a search looks at, over the evaluation bandwidth. Halved, it is the band's Nyquist rate: a gap is two
        springs (d08) and a lag a delay (d13); doubled, nothing changes but the time.
    """

    practical: float = 0.005
    lesser: float = 0.14
    explainable: float = 0.01
    beside: float = 0.02
    held: float = 0.5
    whole: float = 0.07
    unaccounted: float = 0.1
    share: float = 0.05
    certain: float = 3.0
    alike: float = 2.0
    plain: float = 0.15
    hint: float = 2.0
    carried: float = 0.05
    doubted: float = 0.5
    tolerance: float = 0.01
    near: float = 0.8
    neutral: float = 0.1
    resembles: float = 0.5
    line: float = 50.0
    burst: float = 5.0
    steps: int = 4
    rate: float = 4.0

    def __post_init__(self):
        for name, value in asdict(self).items():
            most = 1.0 if name not in ("certain", "alike", "hint", "line", "burst", "steps", "rate") else float("inf")
            if not 0.0 < value <= most:
                allowed = "above 0" if most == float("inf") else "above 0 and at most 1"
                raise WorkbenchError(f"criteria: {name} is {value:g}; it must be {allowed}.")

    @property
    def as_dict(self) -> dict[str, float]:
        """Return every criterion by name, as trace.json holds them."""
        return asdict(self)
