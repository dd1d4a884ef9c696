"""Networks behind one interface, for policies in training, judged and exported."""

from jaxleas.training.networks.actor_critic import ActorCritic, make_networks
from jaxleas.training.networks.making import make_network, network_described
from jaxleas.training.networks.network import Network

__all__ = ["ActorCritic", "Network", "make_network", "make_networks", "network_described"]
