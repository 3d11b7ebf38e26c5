"""The thirty layouts. Where a source says "names", the order and the delimiter are ours."""

from math import pi

from logs import binary, text
from logs.signals import COUNTS, TORQUE_CONSTANT, Layout, axes_of
from logs.signals import Column as C

S, MS, US = ("s", 1.0), ("ms", 1e-3), ("us", 1e-6)
RAD, DEG, COUNT = (("rad", 1.0), ("deg", pi / 180)), (("deg", pi / 180), ("rad", 1.0)), (("cnt", 1 / COUNTS),)
NM = (("Nm", 1.0), ("mNm", 1e-3))
AMPERE = (("A", TORQUE_CONSTANT), ("mA", 1e-3 * TORQUE_CONSTANT))
CURRENT = (("", TORQUE_CONSTANT),)  # no unit is stated
REV = (("", 2 * pi),)


def time(name="time", units=((("", 1.0)),)):
    return C("time", name, units, "time")


def joints(names, *template):
    return axes_of(template, names)


ROS = joints(
    ("shoulder_pan_joint", "elbow_joint", "wrist_1_joint"),
    C("position", "position.@", channel="position"), C("velocity", "velocity.@"), C("torque", "effort.@", channel="drive"),
)  # fmt: skip
MCAP = [C(c.signal, f"/joint_states.{c.name}", c.units, c.channel) for c in ROS]
SCOPE = (
    C("position", "ActPos", (("deg", pi / 180), ("mdeg", pi / 180000)), "position"),
    C("reference", "SetPos", (("deg", pi / 180), ("mdeg", pi / 180000)), "reference"),
    C("torque", "ActTorque", NM, "drive"),
)
BECKHOFF = "Beckhoff Information System, TE13xx TC3 Scope View, Export to CSV; github.com/CagtayFabry/pytcs"

TEXTS = (
    Layout(
        "TwinCAT 3 Scope, a time column per channel", BECKHOFF, ".csv",
        text.scope("\t", full=True, head="Name\tYT Scope Project\nFile\tC:\\axis.svdx\nStarttime of export\t132959949843760000\tMonday, 2 May 2022\t13:56:24.376\nEndtime of export\t132959949853750000\tMonday, 2 May 2022\t13:56:25.375"),
        (time(units=[MS]), *SCOPE), rate=500.0, fixed=1, jitter=False,
    ),
    Layout(
        "TwinCAT 3 Scope, a timeline for each sample time, full time stamps", BECKHOFF, ".csv",
        text.scope(",", full=True, shared=True, ticks=True, head="Name\tYT Scope Project\nFile\tC:\\axis.svdx\nStarttime of export\t132959949843760000\nEndtime of export\t132959949853750000"),
        (time(units=[MS]), *SCOPE), fixed=1, jitter=False,
    ),
    Layout(
        "TwinCAT Scope 2", "Beckhoff Information System, TwinCAT Scope 2, Scope Settings, Export to CSV", ".csv",
        text.scope("\t", full=True, head="Name\tScope01\nFile\nStartRecord\t128783093223690000\tDonnerstag, 5. Februar 2009\t13:08:42\nEndRecord\t128783093339880000\tDonnerstag, 5. Februar 2009\t13:08:53"),
        (time(units=[MS]), *SCOPE[::2]), fixed=1, jitter=False,
    ),
    Layout(
        "LinuxCNC halsampler -t", "LinuxCNC manual pages, halsampler(1): the sample number first, then the pins, no header", ".txt",
        text.table(" ", header=False),
        (C("sample", ""), C("current", "", CURRENT, "drive"), C("position", "", (("", 1.0),), "position"), C("reference", "")),
        fixed=1, jitter=False,
        numbered="column {}", extra=False,
    ),
    Layout(
        "LinuxCNC sampler tools", "github.com/rgbond/sampler_tools, README: the nets' names in the first line, then halsampler's lines", ".log",
        text.table(" "),
        (C("reference", "x-pos-cmd", channel="reference"), C("position", "x-pos-fb", channel="position"), C("current", "x-output-current", CURRENT, "drive")),
        extra=False, jitter=False,
    ),
    Layout(
        "ODrive, np.savetxt", "a public logger of ODrive axes: np.savetxt(header=\"Time (s),Pos_estimate,Vel_estimate (counts/s),Torque_estimate (Nm),...\")", ".csv",
        text.table(mark="# "),
        (time("Time ({})", [S]), C("position", "Pos_estimate", REV, "position"), C("velocity", "Vel_estimate (counts/s)"),
         C("torque", "Torque_estimate ({})", NM, "drive"), C("temperature", "Driver_temp (°C)"), C("temperature", "Motor_temp (°C)")),
        locale=True,
    ),
    Layout(
        "moteus, asyncio logger", 'a public logger of moteus controllers: "id,timestamp,position,velocity,torque,voltage,temperature,fault"', ".csv",
        text.table(),
        (C("still", "id"), time("timestamp"), C("position", "position", REV, "position"), C("velocity", "velocity", REV),
         C("torque", "torque", channel="drive"), C("temperature", "voltage"), C("temperature", "temperature"), C("still", "fault")),
        locale=True, rate=400.0,
    ),
    Layout(
        "moteus pi3hat, np.savetxt without mark", 'a public log of moteus legs: np.savetxt(header="time,position,velocity,torque", comments="")', ".csv",
        text.table(),
        (time("time"), C("position", "position", channel="position"), C("velocity", "velocity"), C("torque", "torque", channel="drive")),
        locale=True,
    ),
    Layout(
        "Elmo Application Studio recorder", "names of the recorder's signals: Position [cnt], Velocity [cnt/s], Active Current [A], Reactive Current [A], Current Command [A]", ".csv",
        text.table(),
        (time("Time [{}]", [S, MS]), C("position", "Position [{}]", COUNT, "position", True), C("velocity", "Velocity [cnt/s]"),
         C("current", "Active Current [{}]", AMPERE, "drive"), C("other current", "Reactive Current [{}]", AMPERE),
         C("reference", "Position Command [{}]", COUNT, "reference", True)),
        rate=2000.0, locale=True,
    ),
    Layout(
        "Schneider Lexium 32 over EtherCAT", "github.com/alessiomargan/ec_master_test, examples/ecat_states/LXM32i_plot.m: ts, pRef, pAct, pDiff, tqAct", ".txt",
        text.table(mark="# "),
        (time("ts", [("", 1e-9)]), C("reference", "pRef", COUNT, "reference", True), C("position", "pAct", COUNT, "position", True),
         C("error", "pDiff"), C("torque", "tqAct", (("", 1e-3),), "drive")),
        rate=1000.0,
    ),
    Layout(
        "KUKA Robot Sensor Interface", "KUKA.RobotSensorInterface telegram: IPOC, AIPos, ASPos, MACur, GearTorque of A1 to A6 (deg, A, Nm)", ".csv",
        text.table(),
        (C("time", "IPOC", [MS], "time"), *joints(("A1", "A2", "A3"), C("position", "AIPos.@", (("", pi / 180),), "position"),
         C("reference", "ASPos.@", (("", pi / 180),)), C("current", "MACur.@", CURRENT, "drive"))),
        rate=250.0, axis="A1", locale=True,
    ),
    Layout(
        "Universal Robots RTDE record.py", "UniversalRobots/RTDE_Python_Client_Library: names with _0 to _5, parted by blanks", ".csv",
        text.table(" "),
        (time("timestamp"), *joints(("0", "1", "2"), C("reference", "target_q_@", channel="reference"), C("position", "actual_q_@", channel="position"),
         C("velocity", "actual_qd_@"), C("current", "actual_current_@", CURRENT, "drive"))),
        rate=500.0, axis="0", extra=False,
    ),
    Layout(
        "Franka, logToCSV of libfranka", 'libfranka, franka::logToCSV: "time, success_rate, q[0], ..., tau_J[0], ..., tau_ext_hat_filtered[0], ..., q_d[0], ..."', ".csv",
        text.table(", "),
        (time("time", [("", 1e-3)]), C("still", "success_rate"), *joints(("0", "1", "2"), C("position", "q[@]", channel="position"), C("velocity", "dq[@]"),
         C("torque", "tau_J[@]", channel="drive"), C("external", "tau_ext_hat_filtered[@]"), C("reference", "q_d[@]", channel="reference"))),
        axis="0",
    ),
    Layout(
        "identification of a seven-axis arm", 'a public identification run: "time,q0,...,q6,dq0,...,ddq0,...,tau0,...,tau6"', ".csv",
        text.table(),
        (time("time"), *joints(("0", "1", "2"), C("position", "q@", channel="position"), C("velocity", "dq@"), C("acceleration", "ddq@"), C("torque", "tau@", channel="drive"))),
        axis="0", locale=True,
    ),
    Layout(
        "VESC Tool, real-time log", "vedderb/vesc_tool: ms_today;input_voltage;temp_mos_max;...;current_motor;current_in;d_axis_current;q_axis_current;erpm;...;encoder_position;...", ".csv",
        text.table(";"),
        (C("time", "ms_today", [MS], "time"), C("still", "input_voltage"), C("temperature", "temp_mos_max"), C("other current", "current_in", CURRENT),
         C("other current", "d_axis_current", CURRENT), C("current", "q_axis_current", CURRENT, "drive"), C("velocity", "erpm"), C("still", "tachometer"),
         C("position", "encoder_position", (("", pi / 180),), "position"), C("still", "fault_code")),
        rate=50.0, locale=True,
    ),
    Layout(
        "microcontroller with an SD card", 'a public motor logger: "timestamp_us,position_rad,velocity_rad_s,torque_cmd_Nm"', ".csv",
        text.table(),
        (time("timestamp_us", [US]), C("position", "position_{}", RAD, "position"), C("velocity", "velocity_rad_s"), C("torque", "torque_cmd_{}", NM, "drive")),
        rate=4000.0, locale=True,
    ),
    Layout(
        "linear stage with a phase column", 'a public test rig: "Time (s),Position (mm),Force (N),Phase"', ".csv",
        text.with_text("Phase", "Exposure"),
        (time("Time ({})", [S, MS]), C("position", "Position ({})", (("mm", 1e-3), ("um", 1e-6)), "position"), C("torque", "Force ({})", (("N", 1.0), ("mN", 1e-3)), "drive")),
        linear=True, locale=True,
    ),
    Layout(
        "testXpert, German", 'a public reader of testXpert exports: rows about the test, a blank row, "Zeit [s];Maschine [mm];Kraft [kN]"', ".csv",
        text.table(";", top="Probenbezeichnung;Achse 3\nEinspannlänge;832.756\nProbenbreite b0;11.4\n\n"),
        (time("Zeit [{}]", [S]), C("position", "Maschine [{}]", (("mm", 1e-3), ("um", 1e-6)), "position"), C("torque", "Kraft [{}]", (("kN", 1e3), ("N", 1.0)), "drive")),
        linear=True, locale=True,
    ),
    Layout(
        "maxon EPOS data recorder", "github.com/EPFLRocketTeam/PropulsionSoftware, python/csv_reader.m, labels: actual position, demand position [inc], actual current, demand current [mA], time [ms]", ".csv",
        text.table(";"),
        (time("time [{}]", [MS]), C("position", "actual position [{}]", (("inc", 1 / COUNTS),), "position", True), C("reference", "demand position [{}]", (("inc", 1 / COUNTS),), "reference", True),
         C("current", "actual current [{}]", (("mA", 1e-3 * TORQUE_CONSTANT), ("A", TORQUE_CONSTANT)), "drive"), C("current", "demand current [{}]", AMPERE), C("velocity", "actual velocity [rpm]")),
        locale=True,
    ),
    Layout(
        "Siemens SINAMICS trace", "names: SINAMICS S120/S150 List Manual, r482 Gn_XIST1, r80 torque actual value; the form 'drive object.parameter' of the trace", ".csv",
        text.table(";"),
        (time("Time [{}]", [MS]), C("position", "SERVO_03.r482[0]: Encoder actual position value Gn_XIST1", COUNT, "position", True),
         C("torque", "SERVO_03.r80: Torque actual value [{}]", NM, "drive"), C("velocity", "SERVO_03.r63: Speed actual value [rpm]"), C("temperature", "SERVO_03.r35: Motor temperature [°C]")),
        rate=4000.0, locale=True,
    ),
    Layout(
        "Dynamixel control table", "ROBOTIS e-Manual, X series, Control Table: Present Position (pulses), Present Current, Goal Position", ".csv",
        text.table(),
        (time("timestamp"), C("reference", "goal_position", (("", 2 * pi / 4096),), "reference", True), C("position", "present_position", (("", 2 * pi / 4096),), "position", True), C("current", "present_current", (("", 2.69e-3 * TORQUE_CONSTANT),), "drive", True)),
        rate=250.0, locale=True,
    ),
    Layout("ros2 topic echo --csv", "ROS 2, ros2topic echo --csv of sensor_msgs/msg/JointState", ".csv", text.echo, (time("time"), *ROS), axis="shoulder_pan_joint", fixed=1, extra=False),
)  # fmt: skip

BINARIES = (
    Layout("JointState, a message a line", "sensor_msgs/msg/JointState as JSON lines", ".jsonl", text.joint_states, (time("header.stamp"), *ROS), axis="shoulder_pan_joint", fixed=1, extra=False),
    Layout("MCAP of ROS 2", "mcap.dev, written by mcap-ros2-support: sensor_msgs/msg/JointState", ".mcap", binary.mcap_ros2, (time("time"), *MCAP), axis="shoulder_pan_joint", fixed=1, extra=False),
    Layout("Parquet of a Beckhoff axis", "written by pyarrow; names: Tc2_MC2, NCTOPLC_AXIS_REF: ActPos, SetPos, ActTorque", ".parquet", binary.parquet,
           (time("Timestamp", [S]), *(C(c.signal, f"Axis1.NcToPlc.{c.name}", c.units, c.channel) for c in SCOPE))),
    Layout("HDF5", "written by h5py, units in attributes", ".h5", binary.hdf5,
           (time("log.time", [S, MS]), C("position", "log.joint.position", RAD, "position"), C("current", "log.motor.current", AMPERE, "drive"), C("temperature", "log.motor.winding"))),
    Layout("MATLAB structure", "MathWorks, MAT-File Format; written by SciPy", ".mat", binary.mat_struct,
           (time("log.t", [("", 1.0)]), C("position", "log.q_{}", RAD, "position"), C("torque", "log.tau_{}", NM, "drive"), C("reference", "log.qr_{}", RAD, "reference")), extra=False),
    Layout("MATLAB matrix of a Scope block", "MathWorks, Simulink, Scope: Log data to workspace, format Array: time first", ".mat", binary.mat_matrix,
           (time("", [("", 1.0)]), C("position", "", channel="position"), C("current", "", CURRENT, "drive")), fixed=1, numbered="ScopeData(:,{})", extra=False),
    Layout("Excel of an oscilloscope export", "written by openpyxl; names: Bosch Rexroth IndraDrive, S-0-0051 and S-0-0084", ".xlsx", binary.excel,
           (time("Time [{}]", [MS, S]), C("position", "S-0-0051, Position feedback value 1 [{}]", DEG, "position"), C("torque", "S-0-0084, Torque/force feedback value [{}]", (("%", 0.05),), "drive"))),
    Layout("WPILib data log", "WPILib, Data Log File Format Specification 1.0; names of its SysId logs: position, velocity, voltage of a motor", ".wpilog", binary.wpilog,
           (time("time", [S]), C("position", "sysid/position-elevator", REV, "position"), C("velocity", "sysid/velocity-elevator", REV), C("torque", "sysid/voltage-elevator", (("", 0.01),), "drive")), rate=200.0, fixed=1, extra=False),
    Layout("TDMS of LabVIEW", "National Instruments, TDMS File Format Internal Structure; written by npTDMS", ".tdms", binary.tdms,
           (time("Time", [S]), C("position", "Encoder", DEG, "position"), C("torque", "Torque", NM, "drive"))),
    Layout("NumPy archive", "written by numpy.savez", ".npz", binary.npz,
           (time("time_s", [S]), C("torque", "torque_{}", NM, "drive"), C("position", "angle_{}", DEG, "position"))),
    Layout("JSON lists", "names: mjbots moteus, telemetry q_current and position", ".json", text.lists,
           (time("t", [("", 1.0)]), C("position", "state.position", REV, "position"), C("current", "state.q_current_{}", (("A", TORQUE_CONSTANT),), "drive"))),
)  # fmt: skip
LAYOUTS = (*TEXTS, *BINARIES)
