"""Names of the package; written by tests/helpers/write_stub.py."""

from idealgas._version import __version__ as __version__
from idealgas.accuracy.study import study_accuracy as study_accuracy
from idealgas.analysis.billiard import BilliardAnalysis
from idealgas.analysis.cooling import CoolingAnalysis
from idealgas.analysis.effusion import EffusionAnalysis
from idealgas.analysis.entropy import EntropyAnalysis
from idealgas.analysis.escape import EscapeAnalysis
from idealgas.analysis.evolution import EvolutionAnalysis
from idealgas.analysis.heat_capacity import HeatCapacityAnalysis
from idealgas.analysis.histogram import HistogramAnalysis
from idealgas.analysis.lyapunov import LyapunovAnalysis
from idealgas.analysis.order import OrderAnalysis
from idealgas.analysis.pressure import PressureAnalysis
from idealgas.analysis.profile import ProfileAnalysis
from idealgas.analysis.registry import analyse as analyse
from idealgas.analysis.registry import combine as combine
from idealgas.analysis.relaxation import RelaxationAnalysis
from idealgas.analysis.scattering import ScatteringAnalysis
from idealgas.analysis.section import SectionAnalysis
from idealgas.analysis.shear import ShearAnalysis
from idealgas.analysis.sound import SoundAnalysis
from idealgas.analysis.temperature import TemperatureAnalysis
from idealgas.analysis.transport import TransportAnalysis
from idealgas.analysis.work import WorkAnalysis
from idealgas.columns import EventBatch as EventBatch
from idealgas.columns import Kind as Kind
from idealgas.errors import OutputError as OutputError
from idealgas.errors import UserError as UserError
from idealgas.examples import load_example as load_example
from idealgas.log import Log as Log
from idealgas.log import LogError as LogError
from idealgas.log import LogState as LogState
from idealgas.log import open_log as open_log
from idealgas.log import takes_path
from idealgas.log.export.export import export as export
from idealgas.log.summary import Summary as Summary
from idealgas.movie.film import animate as animate
from idealgas.report.page import write_report as write_report
from idealgas.run.logged_run import Progress as Progress
from idealgas.run.resume import resume as resume
from idealgas.run.simulate import open_run as open_run
from idealgas.run.simulate import simulate as simulate
from idealgas.scene import Scene as Scene
from idealgas.scene import SceneError as SceneError
from idealgas.scene import load_scene as load_scene
from idealgas.scene import parse_scene as parse_scene
from idealgas.statistics.estimates import Estimate as Estimate
from idealgas.sweep.plan import load_sweep as load_sweep
from idealgas.sweep.run import run_sweep as run_sweep
from idealgas.tallies.tangent_space import sensitivity as sensitivity

billiard = takes_path(BilliardAnalysis.measure)
cooling = takes_path(CoolingAnalysis.measure)
effusion = takes_path(EffusionAnalysis.measure)
entropy = takes_path(EntropyAnalysis.measure)
escape = takes_path(EscapeAnalysis.measure)
evolution = takes_path(EvolutionAnalysis.measure)
heat_capacity = takes_path(HeatCapacityAnalysis.measure)
histogram = takes_path(HistogramAnalysis.measure)
lyapunov = takes_path(LyapunovAnalysis.measure)
order = takes_path(OrderAnalysis.measure)
pressure = takes_path(PressureAnalysis.measure)
profile = takes_path(ProfileAnalysis.measure)
relaxation = takes_path(RelaxationAnalysis.measure)
scattering = takes_path(ScatteringAnalysis.measure)
section = takes_path(SectionAnalysis.measure)
shear = takes_path(ShearAnalysis.measure)
sound = takes_path(SoundAnalysis.measure)
temperature = takes_path(TemperatureAnalysis.measure)
transport = takes_path(TransportAnalysis.measure)
work = takes_path(WorkAnalysis.measure)
